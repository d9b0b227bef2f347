#include "graph/ops/move_pixels.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <tuple>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

using Vector = std::array<double, 3>;

Vector transformed(const HostTensor& m, int64_t image, const Vector& v) {
  Vector out{};
  for (int64_t row = 0; row < 3; ++row) {
    out[static_cast<size_t>(row)] = m.at(image, row, 3);
    for (int64_t column = 0; column < 3; ++column)
      out[static_cast<size_t>(row)] += m.at(image, row, column) * v[static_cast<size_t>(column)];
  }
  return out;
}

HostTensors moved_pixels(const HostTensors& x) {
  const auto [points, location, velocity, omega, m23] = std::tie(x[0], x[1], x[2], x[3], x[4]);
  const Shape& s = points.shape;
  const int64_t slots = omega.shape[1];
  HostTensor moved({s[0], slots + 1, 3, s[2], s[3]});
  for (int64_t b = 0; b < s[0]; ++b)
    for (int64_t k = 0; k <= slots; ++k)
      for (int64_t i = 0; i < s[2]; ++i)
        for (int64_t j = 0; j < s[3]; ++j) {
          Vector at{points.at(b, 0, i, j), points.at(b, 1, i, j), points.at(b, 2, i, j)};
          if (k < slots) {
            const double c = std::cos(omega.at(b, k));
            const double sine = std::sin(omega.at(b, k));
            const double right = at[0] - location.at(b, k, 0);
            const double forward = at[1] - location.at(b, k, 1);
            at = {c * right - sine * forward + location.at(b, k, 0) + velocity.at(b, k, 0),
                  sine * right + c * forward + location.at(b, k, 1) + velocity.at(b, k, 1),
                  at[2] + velocity.at(b, k, 2)};
          }
          const Vector out = transformed(m23, b, at);
          for (int64_t axis = 0; axis < 3; ++axis) moved.at(b, k, axis, i, j) = out[static_cast<size_t>(axis)];
        }
  return {moved};
}

}  // namespace

void check_move_pixels(CheckList& list) {
  struct Case {
    int64_t batch, slots, height, width;
    double turn;
  };
  // 31 x 37 pixels are more than one strip of the reductions; small turns must keep the digits of dX.
  for (const Case& c :
       {Case{1, 1, 1, 1, 3}, Case{3, 3, 5, 7, 3}, Case{2, 2, 31, 37, 1}, Case{2, 5, 9, 8, 0.01}})
    list.push_back({.label = fmt::format("{} x {} slots, {} x {}", c.batch, c.slots, c.height, c.width),
                    .op = std::make_shared<MovePixels>(),
                    .inputs = {row_major({c.batch, 3, c.height, c.width}), row_major({c.batch, c.slots, 3}),
                               row_major({c.batch, c.slots, 3}), row_major({c.batch, c.slots}),
                               row_major({c.batch, 4, 4})},
                    .reference = moved_pixels,
                    .ranges = {{-5.0, 5.0}, {-4.0, 4.0}, {-1.0, 1.0}, {-c.turn, c.turn}, {-1.0, 1.0}}});
}

}  // namespace vkopple
