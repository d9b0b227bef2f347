#include "graph/ops/nearest_rotation.h"

#include <fmt/format.h>

#include "graph/checks/check_turns.h"

namespace vkopple {
namespace {

HostTensors nearest_rotations(const HostTensors& x) {
  HostTensor r(x[0].shape);
  for (size_t i = 0; i < r.values.size() / 9; ++i) set_matrix(r, i, nearest_turn(matrix_at(x[0], i)));
  return {r};
}

/// Matrices U S Vᵀ of given singular values and drawn rotations; the last value may be negative.
std::function<void(HostTensors&)> with_singular_values(const Vector3& values) {
  return [values](HostTensors& x) {
    for (size_t i = 0; i < x[0].values.size() / 9; ++i) {
      const Matrix3 drawn = matrix_at(x[0], i);
      const Matrix3 scale{{{values[0], 0, 0}, {0, values[1], 0}, {0, 0, values[2]}}};
      set_matrix(x[0], i, product(turn_about(drawn[0]), product(scale, transposed(turn_about(drawn[1])))));
    }
  };
}

}  // namespace

// Where the two smaller singular values add up to nothing, gradients are infinite: these come near, from both
// sides of a zero determinant. What happens there is tests/graph/nearest_rotation_test.cpp's.
void check_nearest_rotation(CheckList& list) {
  for (const Vector3& values : {Vector3{1, 1, 1},
                                {1, 0.9, 0.8},
                                {0.9, 0.5, 0.2},
                                {1, 0.5, 0},
                                {1, 0.5, -0.3},
                                {0.7, 0.7, -0.6},
                                {1, 0.03, 0.02},
                                {1, 0.04, 0},
                                {1, 0.5, -0.46},
                                {0.3, 0.3, -0.26}})
    for (const Shape& objects : {Shape{1, 1}, Shape{7, 3}})
      list.push_back({.label = fmt::format("{} of singular values {}, {}, {}", objects.text(), values[0],
                                           values[1], values[2]),
                      .op = std::make_shared<NearestRotation>(),
                      .inputs = {row_major({objects[0], objects[1], 3, 3})},
                      .reference = nearest_rotations,
                      .ranges = {{-3, 3}},
                      .prepare = with_singular_values(values)});
}

}  // namespace vkopple
