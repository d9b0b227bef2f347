#include "graph/ops/rotation_vector.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "graph/checks/check_turns.h"

namespace vkopple {
namespace {

/// Of the rotation nearest to a matrix, whose derivatives across rotations are zero.
Vector3 vector_of(const Matrix3& m) {
  const Matrix3 r = nearest_turn(m);
  const Vector3 sine{(r[2][1] - r[1][2]) / 2, (r[0][2] - r[2][0]) / 2, (r[1][0] - r[0][1]) / 2};
  const double size = norm(sine);
  const double angle = std::atan2(size, (r[0][0] + r[1][1] + r[2][2] - 1) / 2);
  const double scale = size > 0 ? angle / size : 1;
  return {sine[0] * scale, sine[1] * scale, sine[2] * scale};
}

HostTensors rotation_vectors(const HostTensors& x) {
  const Shape& s = x[0].shape;
  HostTensor v({s[0], s[1], 3});
  for (size_t i = 0; i < v.values.size() / 3; ++i) {
    const Vector3 vector = vector_of(matrix_at(x[0], i));
    for (size_t axis = 0; axis < 3; ++axis) v.values[3 * i + axis] = vector[axis];
  }
  return {v};
}

/// Turns by one angle about drawn axes.
std::function<void(HostTensors&)> turns_by(double angle) {
  return [angle](HostTensors& x) {
    for (size_t i = 0; i < x[0].values.size() / 9; ++i) {
      Vector3 axis = matrix_at(x[0], i)[0];
      const double size = norm(axis);
      for (double& a : axis) a *= angle / size;
      set_matrix(x[0], i, turn_about(axis));
    }
  };
}

}  // namespace

// From hardly any turn to nearly half of one, where the vector jumps to its opposite; 0.5 is where a series
// ends.
void check_rotation_vector(CheckList& list) {
  for (const double angle : {1e-3, 0.1, 0.499, 0.501, 1.5, 2.5, std::numbers::pi - 0.01})
    for (const Shape& objects : {Shape{1, 1}, Shape{7, 3}})
      list.push_back({.label = fmt::format("{} turns by {}", objects.text(), angle),
                      .op = std::make_shared<RotationVector>(),
                      .inputs = {row_major({objects[0], objects[1], 3, 3})},
                      .reference = rotation_vectors,
                      .prepare = turns_by(angle)});
}

}  // namespace vkopple
