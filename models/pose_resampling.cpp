#include "models/pose_resampling.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace vkopple {
namespace {

constexpr double kKappa = 100;
/// Fourier coefficients of the density beyond this order are 1e-80 of the first: less than any sum notices.
constexpr int64_t kLastOrder = 250;

/// Logarithms of the von Mises density's Fourier coefficients I_k(κ), up to a common factor that cancels, for
/// orders from 0 on. Ratios of neighbours come from their continued fraction, which only adds: nothing is lost
/// however small they are.
std::vector<double> log_coefficients(int64_t orders) {
  std::vector<double> log_c(static_cast<size_t>(orders) + 1);
  double ratio = 0;
  for (int64_t k = orders + 50; k >= 1; --k) {
    ratio = 1 / (2 * static_cast<double>(k) / kKappa + ratio);
    if (k <= orders) log_c[static_cast<size_t>(k)] = std::log(ratio);
  }
  for (size_t k = 1; k < log_c.size(); ++k) log_c[k] += log_c[k - 1];
  return log_c;
}

/// Orders k + n m, m whole, that a row of n samples cannot tell from k, with their coefficients over the sum of
/// all.
struct Alias {
  double order;
  double share;
};
std::vector<Alias> aliases(int64_t k, int64_t n, const std::vector<double>& log_c) {
  std::vector<Alias> found;
  const auto last = static_cast<int64_t>(log_c.size()) - 1;
  const int64_t low = k - (k + last) / n * n;
  double largest = -INFINITY;
  for (int64_t order = low; order <= last; order += n)
    largest = std::max(largest, log_c[static_cast<size_t>(std::abs(order))]);
  double sum = 0;
  for (int64_t order = low; order <= last; order += n) {
    const double c = std::exp(log_c[static_cast<size_t>(std::abs(order))] - largest);
    found.push_back({static_cast<double>(order), c});
    sum += c;
  }
  for (Alias& alias : found) alias.share /= sum;
  return found;
}

}  // namespace

std::vector<float> resampling_rows(int64_t bins) {
  // Both factors are circulant in n - m, hence diagonal in the Fourier basis: T's first row is the inverse
  // transform of the quotient of theirs, Σ c e^{i order a} / Σ c over the orders that alias with k.
  const auto n = static_cast<size_t>(bins);
  const auto log_c = log_coefficients(std::max(kLastOrder, bins));
  std::vector<std::vector<Alias>> of(n);
  std::vector<std::complex<double>> roots(n);
  for (size_t k = 0; k < n; ++k) {
    of[k] = aliases(static_cast<int64_t>(k), bins, log_c);
    roots[k] = std::polar(1.0, 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  }
  std::vector<float> rows;
  rows.reserve(static_cast<size_t>(kResamplingAngles) * n);
  std::vector<std::complex<double>> quotient(n);
  for (int64_t a = 0; a < kResamplingAngles; ++a) {
    const double angle = static_cast<double>(a - 180) * std::numbers::pi / 180;
    for (size_t k = 0; k < n; ++k) {
      quotient[k] = 0;
      for (const Alias& alias : of[k]) quotient[k] += std::polar(alias.share, alias.order * angle);
    }
    for (size_t d = 0; d < n; ++d) {
      double sum = 0;
      for (size_t k = 0, at = 0; k < n; ++k) {
        sum += quotient[k].real() * roots[at].real() - quotient[k].imag() * roots[at].imag();
        at += d;
        if (at >= n) at -= n;
      }
      rows.push_back(static_cast<float>(sum / static_cast<double>(n)));
    }
  }
  return rows;
}

}  // namespace vkopple
