#include "graph/ops/imagination_condition.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {

void check_imagination_condition(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    const Shape& s = x[1].shape;
    HostTensor condition({s[0], s[1] + 1, 7});
    for (int64_t b = 0; b < s[0]; ++b)
      for (int64_t k = 0; k <= s[1]; ++k) {
        for (int64_t c = 0; c < 3; ++c) condition.at(b, k, c) = x[0].at(b, c);
        if (k == s[1]) {
          condition.at(b, k, 5) = 1;
          continue;
        }
        for (int64_t c = 0; c < 2; ++c) {
          condition.at(b, k, 3 + c) = x[1].at(b, k, c);
          condition.at(b, k, 5 + c) = x[2].at(b, k, c);
        }
      }
    return HostTensors{condition};
  };
  for (const auto& [batch, slots] : {std::pair<int64_t, int64_t>{1, 1}, {5, 3}, {37, 2}, {2, 7}})
    list.push_back(
        {.label = fmt::format("{} x {} slots", batch, slots),
         .op = std::make_shared<ImaginationCondition>(),
         .inputs = {row_major({batch, 3}), row_major({batch, slots, 3}), row_major({batch, slots, 2})},
         .reference = reference});
}

}  // namespace vkopple
