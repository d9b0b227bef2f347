#include "graph/ops/imagination_input.h"

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {

void check_imagination_input(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    const Shape& s = x[2].shape;
    HostTensor y({s[0] * s[1], 4, s[2], s[3]});
    for (int64_t b = 0; b < s[0]; ++b)
      for (int64_t k = 0; k < s[1]; ++k)
        for (int64_t i = 0; i < s[2]; ++i)
          for (int64_t j = 0; j < s[3]; ++j) {
            const double mask = x[2].at(b, k, i, j);
            const int64_t n = b * s[1] + k;
            for (int64_t c = 0; c < 3; ++c) y.at(n, c, i, j) = mask * x[0].at(b, c, i, j);
            y.at(n, 3, i, j) = mask * std::log(x[1].at(b, 0, i, j) + 1e-5);
          }
    return HostTensors{y};
  };
  struct Case {
    Shape masks;
    std::pair<double, double> depth;
  };
  for (const auto& [masks, depth] : {Case{{1, 1, 1, 1}, {0.05, 7.0}}, Case{{3, 4, 5, 7}, {0.05, 7.0}},
                                     Case{{2, 2, 9, 8}, {0.003, 0.006}},  // 1e-5 counts
                                     Case{{1, 3, 13, 11}, {0.05, 7.0}}})
    list.push_back({.label = masks.text(),
                    .op = std::make_shared<ImaginationInput>(),
                    .inputs = {row_major(masks.with(1, 3)), row_major(masks.with(1, 1)), row_major(masks)},
                    .reference = reference,
                    .ranges = {{0.0, 1.0}, depth, {0.0, 1.0}}});
}

}  // namespace vkopple
