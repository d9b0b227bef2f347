#pragma once

#include <cstdint>

namespace vkopple {

/// The sizes of a square-kernel convolution, whichever of its three products is computed:
///   y[n, co, yo, xo] = Σ ci,ky,kx  x[n, ci, yi, xi] · w[co, ci, ky, kx]
///   yi = yo · stride + ky · dilation − padding, xi likewise, x being zero outside (h, w).
/// x is (n, ci, h, w), y is (n, co, ho, wo), w is (co, ci, kernel, kernel).
struct ConvShape {
  int64_t n, ci, h, w, co, ho, wo;
  int64_t kernel, stride, padding, dilation;

  /// Of one of the three products, a multiply and an add counting one each.
  double flop() const {
    return 2.0 * static_cast<double>(n * ho * wo) * static_cast<double>(co * ci) *
           static_cast<double>(kernel * kernel);
  }
  bool operator==(const ConvShape&) const = default;
};

}  // namespace vkopple
