#include "graph/ops/move_pixels.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check_turns.h"

namespace vkopple {
namespace {

Matrix3 turn_at(const HostTensor& turns, size_t object) {
  if (turns.shape.rank() == 4) return matrix_at(turns, object);
  const double c = std::cos(turns.values[object]);
  const double s = std::sin(turns.values[object]);
  return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}

/// Turns points about `about`, then shifts them; as made, leaves them where they are.
struct RigidTurn {
  Matrix3 turn = identity3();
  Vector3 about{};
  Vector3 shift{};

  Vector3 of(Vector3 point) const {
    for (size_t axis = 0; axis < 3; ++axis) point[axis] -= about[axis];
    Vector3 out = times(turn, point);
    for (size_t axis = 0; axis < 3; ++axis) out[axis] += about[axis] + shift[axis];
    return out;
  }
};

RigidTurn camera_at(const HostTensor& m23, int64_t image) {
  RigidTurn camera;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t column = 0; column < 3; ++column) camera.turn[row][column] = m23.at(image, row, column);
    camera.shift[row] = m23.at(image, row, 3);
  }
  return camera;
}

HostTensors moved_pixels(const HostTensors& x) {
  const auto &points = x[0], &location = x[1], &velocity = x[2], &turns = x[3], &m23 = x[4];
  const Shape& s = points.shape;
  const int64_t slots = turns.shape[1];
  HostTensor moved({s[0], slots + 1, 3, s[2], s[3]});
  for (int64_t b = 0; b < s[0]; ++b) {
    const RigidTurn camera = camera_at(m23, b);
    for (int64_t k = 0; k <= slots; ++k) {
      RigidTurn own;
      if (k < slots) {
        const auto object = static_cast<size_t>(b * slots + k);
        own = {turn_at(turns, object), vector_at(location, object), vector_at(velocity, object)};
      }
      for (int64_t i = 0; i < s[2]; ++i)
        for (int64_t j = 0; j < s[3]; ++j) {
          const Vector3 to =
              camera.of(own.of({points.at(b, 0, i, j), points.at(b, 1, i, j), points.at(b, 2, i, j)}));
          for (size_t axis = 0; axis < 3; ++axis) moved.at(b, k, axis, i, j) = to[axis];
        }
    }
  }
  return {moved};
}

}  // namespace

void check_move_pixels(CheckList& list) {
  struct Case {
    int64_t batch, slots, height, width;
    double angle;
  };
  // 31 x 37 pixels are more than one strip of the reductions; small angles must keep the digits of dX.
  for (const Case& c :
       {Case{1, 1, 1, 1, 3}, Case{3, 3, 5, 7, 3}, Case{2, 2, 31, 37, 1}, Case{2, 5, 9, 8, 0.01}})
    for (const bool matrices : {false, true}) {
      const Shape turns = matrices ? Shape{c.batch, c.slots, 3, 3} : Shape{c.batch, c.slots};
      const double most = matrices ? 1 : c.angle;
      list.push_back(
          {.label = fmt::format("{} x {} slots, {} x {}, {}", c.batch, c.slots, c.height, c.width,
                                matrices ? "matrices" : "angles"),
           .op = std::make_shared<MovePixels>(),
           .inputs = {row_major({c.batch, 3, c.height, c.width}), row_major({c.batch, c.slots, 3}),
                      row_major({c.batch, c.slots, 3}), row_major(turns), row_major({c.batch, 4, 4})},
           .reference = moved_pixels,
           .ranges = {{-5.0, 5.0}, {-4.0, 4.0}, {-1.0, 1.0}, {-most, most}, {-1.0, 1.0}}});
    }
}

}  // namespace vkopple
