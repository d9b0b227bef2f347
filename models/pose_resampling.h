#pragma once

#include <cstdint>
#include <vector>

namespace vkopple {

constexpr int64_t kResamplingAngles = 361;  ///< whole degrees from -180 to 180

/// The matrices T(a) = K_a K_0⁻¹ with K_a[m, n] = vonMises(θ_n - θ_m + a; κ = 100), for a = -180° … 180°, as
/// (361, bins, bins) row-major (docs/model.md §4). K_0 is ill-conditioned (2e7), so they are built in double.
std::vector<float> resampling_matrices(int64_t bins);

}  // namespace vkopple
