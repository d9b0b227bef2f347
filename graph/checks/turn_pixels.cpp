#include "graph/ops/move_pixels.h"

#include <fmt/format.h>

#include "graph/checks/check_turns.h"

namespace vkopple {
namespace {

HostTensors turned_pixels(const HostTensors& x) {
  const auto &points = x[0], &location = x[1], &velocity = x[2], &turn = x[3], &m23 = x[4];
  const Shape& s = points.shape;
  const int64_t slots = turn.shape[1];
  HostTensor moved({s[0], slots + 1, 3, s[2], s[3]});
  for (int64_t b = 0; b < s[0]; ++b)
    for (int64_t k = 0; k <= slots; ++k)
      for (int64_t i = 0; i < s[2]; ++i)
        for (int64_t j = 0; j < s[3]; ++j) {
          Vector3 at{points.at(b, 0, i, j), points.at(b, 1, i, j), points.at(b, 2, i, j)};
          if (k < slots) {
            Vector3 turned{};
            for (int64_t row = 0; row < 3; ++row) {
              turned[static_cast<size_t>(row)] = location.at(b, k, row) + velocity.at(b, k, row);
              for (int64_t column = 0; column < 3; ++column)
                turned[static_cast<size_t>(row)] +=
                    turn.at(b, k, row, column) * (at[static_cast<size_t>(column)] - location.at(b, k, column));
            }
            at = turned;
          }
          for (int64_t row = 0; row < 3; ++row) {
            double out = m23.at(b, row, 3);
            for (int64_t column = 0; column < 3; ++column)
              out += m23.at(b, row, column) * at[static_cast<size_t>(column)];
            moved.at(b, k, row, i, j) = out;
          }
        }
  return {moved};
}

}  // namespace

void check_turn_pixels(CheckList& list) {
  struct Case {
    int64_t batch, slots, height, width;
  };
  // 31 x 37 pixels are more than one strip of the reductions.
  for (const Case& c : {Case{1, 1, 1, 1}, Case{3, 3, 5, 7}, Case{2, 2, 31, 37}, Case{2, 5, 9, 8}})
    list.push_back({.label = fmt::format("{} x {} slots, {} x {}", c.batch, c.slots, c.height, c.width),
                    .op = std::make_shared<MovePixels>(),
                    .inputs = {row_major({c.batch, 3, c.height, c.width}), row_major({c.batch, c.slots, 3}),
                               row_major({c.batch, c.slots, 3}), row_major({c.batch, c.slots, 3, 3}),
                               row_major({c.batch, 4, 4})},
                    .reference = turned_pixels,
                    .ranges = {{-5.0, 5.0}, {-4.0, 4.0}, {-1.0, 1.0}, {-1.0, 1.0}, {-1.0, 1.0}}});
}

}  // namespace vkopple
