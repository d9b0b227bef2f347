#pragma once

#include <array>

#include "graph/checks/check.h"

namespace vkopple {

// 3×3 matrices and turns in plain double precision, for references and for making inputs.

using Vector3 = std::array<double, 3>;
using Matrix3 = std::array<std::array<double, 3>, 3>;  ///< rows

Matrix3 identity3();
Matrix3 product(const Matrix3& a, const Matrix3& b);
Matrix3 transposed(const Matrix3& m);
Vector3 times(const Matrix3& m, const Vector3& v);
double norm(const Vector3& v);

/// Matrix or vector number `object` of a tensor (B, K, 3, 3) or (B, K, 3).
Matrix3 matrix_at(const HostTensor& tensor, size_t object);
void set_matrix(HostTensor& tensor, size_t object, const Matrix3& m);
Vector3 vector_at(const HostTensor& tensor, size_t object);

/// The rotation about v by |v|, as the series of the matrix exponential.
Matrix3 turn_about(const Vector3& v);
/// The rotation with the largest trace of RᵀM, by the singular vectors of M; its second singular value must not
/// be 0.
Matrix3 nearest_turn(const Matrix3& m);

}  // namespace vkopple
