#include "models/pose_resampling.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace vkopple {
namespace {

constexpr double kKappa = 100;

/// exp(κ (cos x - 1)): the von Mises density up to a factor that cancels in K_a K_0⁻¹.
double density(double x) { return std::exp(kKappa * (std::cos(x) - 1)); }

using Complexes = std::vector<std::complex<double>>;

/// Discrete Fourier transform of a real sequence, directly: bins are few and this runs once.
Complexes transform(const std::vector<double>& values) {
  const size_t n = values.size();
  Complexes out(n);
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      out[k] += values[j] * std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(j * k % n) /
                                                static_cast<double>(n));
  return out;
}

}  // namespace

std::vector<float> resampling_matrices(int64_t bins) {
  // Both factors are circulant in n - m, hence diagonal in the Fourier basis: T's first row is the inverse
  // transform of the quotient of theirs, far better conditioned than a matrix inverse.
  const auto n = static_cast<size_t>(bins);
  const double step = 2 * std::numbers::pi / static_cast<double>(n);
  const auto row = [&](double angle) {
    std::vector<double> values(n);
    for (size_t j = 0; j < n; ++j) values[j] = density(static_cast<double>(j) * step + angle);
    return values;
  };
  const Complexes base = transform(row(0));
  std::vector<float> all;
  all.reserve(static_cast<size_t>(kResamplingAngles) * n * n);
  for (int64_t a = 0; a < kResamplingAngles; ++a) {
    const Complexes shifted = transform(row(static_cast<double>(a - 180) * std::numbers::pi / 180));
    std::vector<double> first(n);
    for (size_t d = 0; d < n; ++d) {
      std::complex<double> sum = 0;
      for (size_t k = 0; k < n; ++k)
        sum += shifted[k] / base[k] *
               std::polar(1.0, 2 * std::numbers::pi * static_cast<double>(d * k % n) / static_cast<double>(n));
      first[d] = sum.real() / static_cast<double>(n);
    }
    for (size_t m = 0; m < n; ++m)
      for (size_t k = 0; k < n; ++k) all.push_back(static_cast<float>(first[(k + n - m) % n]));
  }
  return all;
}

}  // namespace vkopple
