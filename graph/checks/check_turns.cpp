#include "graph/checks/check_turns.h"

#include <cmath>

namespace vkopple {
namespace {

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector3 unit(const Vector3& v) {
  const double size = norm(v);
  return {v[0] / size, v[1] / size, v[2] / size};
}

/// Unit vectors orthogonal to each other: eigenvectors of the symmetric matrix a by Jacobi's rotations, the
/// largest eigenvalue's first.
std::array<Vector3, 3> eigenvectors(Matrix3 a) {
  Matrix3 v = identity3();
  for (int sweep = 0; sweep < 30; ++sweep)
    for (size_t i = 0; i < 2; ++i)
      for (size_t j = i + 1; j < 3; ++j) {
        const double angle = 0.5 * std::atan2(2 * a[i][j], a[i][i] - a[j][j]);
        Matrix3 turn = identity3();
        turn[i][i] = turn[j][j] = std::cos(angle);
        turn[j][i] = std::sin(angle);
        turn[i][j] = -turn[j][i];
        a = product(transposed(turn), product(a, turn));
        v = product(v, turn);
      }
  std::array<size_t, 3> order{0, 1, 2};
  for (size_t i = 0; i < 2; ++i)
    for (size_t j = i + 1; j < 3; ++j)
      if (a[order[j]][order[j]] > a[order[i]][order[i]]) std::swap(order[i], order[j]);
  std::array<Vector3, 3> vectors{};
  for (size_t i = 0; i < 3; ++i) vectors[i] = {v[0][order[i]], v[1][order[i]], v[2][order[i]]};
  return vectors;
}

}  // namespace

Matrix3 identity3() { return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}; }

Matrix3 product(const Matrix3& a, const Matrix3& b) {
  Matrix3 out{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      for (size_t k = 0; k < 3; ++k) out[i][j] += a[i][k] * b[k][j];
  return out;
}

Vector3 times(const Matrix3& m, const Vector3& v) {
  Vector3 out{};
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = 0; column < 3; ++column) out[row] += m[row][column] * v[column];
  return out;
}

double norm(const Vector3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

Matrix3 transposed(const Matrix3& m) {
  Matrix3 out{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) out[i][j] = m[j][i];
  return out;
}

Matrix3 matrix_at(const HostTensor& tensor, size_t object) {
  Matrix3 m{};
  for (size_t i = 0; i < 9; ++i) m[i / 3][i % 3] = tensor.values[object * 9 + i];
  return m;
}

void set_matrix(HostTensor& tensor, size_t object, const Matrix3& m) {
  for (size_t i = 0; i < 9; ++i) tensor.values[object * 9 + i] = m[i / 3][i % 3];
}

Vector3 vector_at(const HostTensor& tensor, size_t object) {
  return {tensor.values[object * 3], tensor.values[object * 3 + 1], tensor.values[object * 3 + 2]};
}

Matrix3 turn_about(const Vector3& v) {
  // exp([v]x) = exp([v / 16]x)^16: the series is short, and no formula of sines is shared with the shaders.
  constexpr int kHalvings = 4;
  const double s = std::pow(0.5, kHalvings);
  const Matrix3 k{{{0, -v[2] * s, v[1] * s}, {v[2] * s, 0, -v[0] * s}, {-v[1] * s, v[0] * s, 0}}};
  Matrix3 sum = identity3();
  Matrix3 term = identity3();
  for (int n = 1; n <= 20; ++n) {
    term = product(term, k);
    for (auto& row : term)
      for (double& x : row) x /= n;
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) sum[i][j] += term[i][j];
  }
  for (int n = 0; n < kHalvings; ++n) sum = product(sum, sum);
  return sum;
}

Matrix3 nearest_turn(const Matrix3& m) {
  // M = U S Vᵀ; the third vectors follow from the others, so that both U and V are rotations.
  const auto v = eigenvectors(product(transposed(m), m));
  const Vector3 v3 = cross(v[0], v[1]);
  const Vector3 u1 = unit(times(m, v[0]));
  Vector3 u2 = times(m, v[1]);
  const double along = u2[0] * u1[0] + u2[1] * u1[1] + u2[2] * u1[2];
  for (size_t i = 0; i < 3; ++i) u2[i] -= along * u1[i];
  u2 = unit(u2);
  const Vector3 u3 = cross(u1, u2);
  Matrix3 r{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) r[i][j] = u1[i] * v[0][j] + u2[i] * v[1][j] + u3[i] * v3[j];
  return r;
}

}  // namespace vkopple
