#include "graph/ops/imagination_condition.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {

void check_imagination_condition(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    const Shape& s = x[1].shape;
    const int64_t ego = x[0].shape[1];
    const int64_t turn = x[2].shape[2];
    HostTensor condition({s[0], s[1] + 1, ego + 2 * turn});
    for (int64_t b = 0; b < s[0]; ++b)
      for (int64_t k = 0; k <= s[1]; ++k) {
        for (int64_t c = 0; c < ego; ++c) condition.at(b, k, c) = x[0].at(b, c);
        if (k == s[1]) {
          if (turn == 2) condition.at(b, k, ego + 2) = 1;
          continue;
        }
        for (int64_t c = 0; c < turn; ++c) {
          condition.at(b, k, ego + c) = x[1].at(b, k, c);
          condition.at(b, k, ego + turn + c) = x[2].at(b, k, c);
        }
      }
    return HostTensors{condition};
  };
  for (const auto& [ego, turn] : {std::pair<int64_t, int64_t>{3, 2}, {6, 3}})
    for (const auto& [batch, slots] : {std::pair<int64_t, int64_t>{1, 1}, {5, 3}, {37, 2}, {2, 7}})
      list.push_back(
          {.label = fmt::format("{} x {} slots, {} numbers of ego-motion", batch, slots, ego),
           .op = std::make_shared<ImaginationCondition>(),
           .inputs = {row_major({batch, ego}), row_major({batch, slots, 3}), row_major({batch, slots, turn})},
           .reference = reference});
}

}  // namespace vkopple
