#pragma once

#include <vector>

#include "graph/conv/conv_shape.h"

namespace vkopple::test {

/// Calls f(x index, w index, y index) for every product of the convolution's sum; tensors are row-major.
template <class F>
void each_product(const ConvShape& s, const F& f) {
  const int64_t k = s.kernel;
  for (int64_t n = 0; n < s.n; ++n)
    for (int64_t co = 0; co < s.co; ++co)
      for (int64_t ci = 0; ci < s.ci; ++ci)
        for (int64_t tap = 0; tap < k * k; ++tap)
          for (int64_t yo = 0; yo < s.ho; ++yo)
            for (int64_t xo = 0; xo < s.wo; ++xo) {
              const int64_t yi = yo * s.stride + tap / k * s.dilation - s.padding;
              const int64_t xi = xo * s.stride + tap % k * s.dilation - s.padding;
              if (yi < 0 || yi >= s.h || xi < 0 || xi >= s.w) continue;
              f(static_cast<size_t>(((n * s.ci + ci) * s.h + yi) * s.w + xi),
                static_cast<size_t>((co * s.ci + ci) * k * k + tap),
                static_cast<size_t>(((n * s.co + co) * s.ho + yo) * s.wo + xo));
            }
}

}  // namespace vkopple::test
