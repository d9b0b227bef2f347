#include "graph/ops/adaptive_avg_pool.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

int64_t first_of(int64_t bin, int64_t bins, int64_t size) {
  return static_cast<int64_t>(std::floor(static_cast<double>(bin * size) / static_cast<double>(bins)));
}
int64_t end_of(int64_t bin, int64_t bins, int64_t size) {
  return static_cast<int64_t>(std::ceil(static_cast<double>((bin + 1) * size) / static_cast<double>(bins)));
}

HostTensors reference(const HostTensor& x, int64_t height, int64_t width) {
  HostTensor y({x.shape[0], x.shape[1], height, width});
  for (int64_t n = 0; n < x.shape[0]; ++n)
    for (int64_t c = 0; c < x.shape[1]; ++c)
      for (int64_t i = 0; i < height; ++i)
        for (int64_t j = 0; j < width; ++j) {
          double sum = 0;
          int64_t count = 0;
          for (int64_t u = first_of(i, height, x.shape[2]); u < end_of(i, height, x.shape[2]); ++u)
            for (int64_t v = first_of(j, width, x.shape[3]); v < end_of(j, width, x.shape[3]); ++v, ++count)
              sum += x.at(n, c, u, v);
          y.at(n, c, i, j) = sum / static_cast<double>(count);
        }
  return {y};
}

}  // namespace

void check_adaptive_avg_pool(CheckList& list) {
  struct Case {
    Shape x;
    int64_t height, width;
  };
  for (const Case& c : {Case{{1, 1, 1, 1}, 1, 1}, Case{{2, 3, 16, 8}, 4, 4}, Case{{1, 5, 7, 11}, 4, 4},
                        Case{{1, 4, 2, 3}, 4, 4}, Case{{2, 2, 5, 1}, 1, 3}, Case{{1, 6, 13, 6}, 5, 4}})
    list.push_back({.label = fmt::format("{} to {} x {}", c.x.text(), c.height, c.width),
                    .op = std::make_shared<AdaptiveAvgPool>(c.height, c.width),
                    .inputs = {channels4(c.x)},
                    .reference = [c](const HostTensors& x) { return reference(x[0], c.height, c.width); }});
}

}  // namespace vkopple
