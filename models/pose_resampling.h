#pragma once

#include <cstdint>
#include <vector>

namespace vkopple {

constexpr int64_t kResamplingAngles = 361;  ///< whole degrees from -180 to 180

/// The matrices T(a) = K_a K_0⁻¹ with K_a[m, n] = vonMises(θ_n - θ_m + a; κ = 100), for a = -180° … 180°, by
/// their first rows (361, bins): T[m, n] is row[(n - m) mod bins] (docs/model.md §4). K_0 is ill-conditioned,
/// about as exp(bins² / 800); what is computed here is right for any number of bins.
std::vector<float> resampling_rows(int64_t bins);

}  // namespace vkopple
