#include "graph/ops/nearest_rotation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "graph/checks/check_turns.h"
#include "graph/executor.h"
#include "graph/ops/binary.h"
#include "graph/ops/reduce_sum.h"
#include "runtime/error.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using Nine = std::vector<float>;

Matrix3 matrix(const Nine& values, size_t object = 0) {
  Matrix3 m{};
  for (size_t i = 0; i < 9; ++i) m[i / 3][i % 3] = values[9 * object + i];
  return m;
}

double trace(const Matrix3& m) { return m[0][0] + m[1][1] + m[2][2]; }

struct Result {
  Nine rotation;
  Nine gradient;
};

/// The rotation nearest to m, and the gradient of the sum of its entries times `weights`.
Result nearest(const Nine& m, const Nine& weights) {
  Graph graph;
  const Value x = graph.parameter("matrices", "m", {1, 1, 3, 3});
  const Value w = graph.input("weights", row_major({1, 1, 3, 3}));
  const Value r = nearest_rotation(x);
  graph.keep("rotation", r);
  const Value loss = reduce_sum(mul(r, w), {0, 1, 2, 3});
  Executor executor(test_device(), graph, {.loss = loss, .trained = {"matrices"}});
  executor.write(x, m);
  executor.write(w, weights);
  executor.forward();
  executor.backward();
  return {executor.read(r), executor.read_gradient(x)};
}

const Nine kWeights{0.3F, -1, 0.5F, 0.25F, 0.75F, -0.5F, 1, 0.125F, -0.25F};

class DegenerateTest : public testing::TestWithParam<Nine> {};

// Where a whole circle of rotations is nearest: one of them, and a finite gradient.
TEST_P(DegenerateTest, IsARotationOfTheLargestTraceWithAFiniteGradient) {
  const Nine m = GetParam();
  const Result result = nearest(m, kWeights);
  const Matrix3 r = matrix(result.rotation);
  const Matrix3 unit = product(transposed(r), r);
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) EXPECT_NEAR(unit[i][j], i == j ? 1 : 0, 1e-5);
  const double determinant = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
                             r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
                             r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
  EXPECT_NEAR(determinant, 1, 1e-5);
  const double reached = trace(product(transposed(r), matrix(m)));
  for (const Vector3& axis : {Vector3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6, 0.8, 0}, {0.6, 0, -0.8}})
    for (double angle = 0; angle < 6.3; angle += 0.1) {
      const Matrix3 other = turn_about({axis[0] * angle, axis[1] * angle, axis[2] * angle});
      EXPECT_LE(trace(product(transposed(other), matrix(m))), reached + 1e-5);
    }
  for (const float g : result.gradient) EXPECT_LT(std::abs(g), 10) << "of " << testing::PrintToString(m);
}

INSTANTIATE_TEST_SUITE_P(Matrices, DegenerateTest,
                         testing::Values(Nine(9, 0.0F),                       // every rotation
                                         Nine{1, 0, 0, 0, 1, 0, 0, 0, -1},    // a mirror
                                         Nine{-1, 0, 0, 0, -1, 0, 0, 0, -1},  // all mirrors
                                         Nine{0, 0, 0.5F, 0, 0, 0, 0, 0, 0},  // rank 1
                                         Nine{0, 1, 0, 1, 0, 0, 0, 0, 1}));   // two axes exchanged

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// diag(2, 1, -1): the sums are 2 + 1, 2 - 1 and 0. The gradient R [h]x solves G h = g, G = tr(P) 1 - P with P =
// R^T M, in all directions but the free one, where it has none.
TEST(NearestRotationTest, GradientsOfAMirrorLeaveOutTheFreeDirection) {
  const Result result = nearest({2, 0, 0, 0, 1, 0, 0, 0, -1}, kWeights);
  const Matrix3 back = transposed(matrix(result.rotation));
  const Matrix3 p = product(back, Matrix3{{{2, 0, 0}, {0, 1, 0}, {0, 0, -1}}});
  const Matrix3 c = product(back, matrix(kWeights));
  const Vector3 g{c[2][1] - c[1][2], c[0][2] - c[2][0], c[1][0] - c[0][1]};
  const Vector3 free = times(back, {1, 0, 0});
  const Matrix3 cross = product(back, matrix(result.gradient));
  const Vector3 h{cross[2][1], cross[0][2], cross[1][0]};
  const Vector3 ph = times(p, h);
  EXPECT_NEAR(dot(h, free), 0, 1e-4);
  EXPECT_GT(dot(h, h), 0.1);
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(trace(p) * h[i] - ph[i], g[i] - dot(g, free) * free[i], 1e-4);
}

TEST(NearestRotationTest, RefusesOtherShapes) {
  Graph graph;
  EXPECT_THROW(nearest_rotation(graph.input("m", row_major({1, 1, 3, 4}))), Error);
  EXPECT_THROW(nearest_rotation(graph.input("n", row_major({1, 3, 3}))), Error);
}

}  // namespace
}  // namespace vkopple
