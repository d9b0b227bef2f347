#include "graph/ops/resize_bilinear.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

/// Hat function of the distance between an input and where an output lies.
double nearness(int64_t out, int64_t out_size, int64_t in, int64_t in_size) {
  const double at =
      out_size > 1 ? static_cast<double>(out * (in_size - 1)) / static_cast<double>(out_size - 1) : 0;
  return std::max(0.0, 1.0 - std::abs(at - static_cast<double>(in)));
}

HostTensors reference(const HostTensor& x, int64_t height, int64_t width) {
  HostTensor y({x.shape[0], x.shape[1], height, width});
  for (int64_t n = 0; n < x.shape[0]; ++n)
    for (int64_t c = 0; c < x.shape[1]; ++c)
      for (int64_t i = 0; i < height; ++i)
        for (int64_t j = 0; j < width; ++j)
          for (int64_t u = 0; u < x.shape[2]; ++u)
            for (int64_t v = 0; v < x.shape[3]; ++v)
              y.at(n, c, i, j) +=
                  nearness(i, height, u, x.shape[2]) * nearness(j, width, v, x.shape[3]) * x.at(n, c, u, v);
  return {y};
}

}  // namespace

void check_resize_bilinear(CheckList& list) {
  struct Case {
    Shape x;
    int64_t height, width;
  };
  for (const Case& c : {Case{{1, 1, 1, 1}, 1, 1}, Case{{2, 3, 4, 4}, 16, 16}, Case{{1, 5, 1, 1}, 3, 5},
                        Case{{1, 4, 5, 7}, 1, 13}, Case{{2, 3, 7, 5}, 3, 2}, Case{{1, 2, 4, 4}, 4, 5},
                        Case{{1, 1, 1, 3}, 4, 1}, Case{{1, 3, 9, 2}, 8, 9}})
    list.push_back({.label = fmt::format("{} to {} x {}", c.x.text(), c.height, c.width),
                    .op = std::make_shared<ResizeBilinear>(c.height, c.width),
                    .inputs = {channels4(c.x)},
                    .reference = [c](const HostTensors& x) { return reference(x[0], c.height, c.width); }});
}

}  // namespace vkopple
