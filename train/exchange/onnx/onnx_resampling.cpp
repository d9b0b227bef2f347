#include <algorithm>

#include "train/exchange/onnx/onnx_translators.h"

namespace vkopple {
namespace {

/// Rows are places of the result, columns those of the input; row-major.
using Matrix = std::vector<float>;
using MatrixOf = Matrix (*)(std::int64_t to, std::int64_t from);

std::size_t at(std::int64_t row, std::int64_t columns, std::int64_t column) {
  return static_cast<std::size_t>(row * columns + column);
}

/// Means over bins that may overlap (graph/ops/adaptive_avg_pool.h).
Matrix pooling(std::int64_t to, std::int64_t from) {
  Matrix matrix(static_cast<std::size_t>(to * from), 0.0F);
  for (std::int64_t i = 0; i < to; ++i) {
    const std::int64_t begin = i * from / to;
    const std::int64_t end = ((i + 1) * from + to - 1) / to;
    for (std::int64_t u = begin; u < end; ++u) matrix[at(i, from, u)] = 1.0F / static_cast<float>(end - begin);
  }
  return matrix;
}

/// Aligned corners (graph/ops/resize_bilinear.h).
Matrix bilinear(std::int64_t to, std::int64_t from) {
  Matrix matrix(static_cast<std::size_t>(to * from), 0.0F);
  for (std::int64_t i = 0; i < to; ++i) {
    const double place = to == 1 ? 0 : static_cast<double>(i * (from - 1)) / static_cast<double>(to - 1);
    const auto below = std::min(static_cast<std::int64_t>(place), from - 1);
    const auto share = static_cast<float>(place - static_cast<double>(below));
    matrix[at(i, from, below)] += 1 - share;
    matrix[at(i, from, std::min(below + 1, from - 1))] += share;
  }
  return matrix;
}

Matrix transposed(const Matrix& matrix, std::int64_t rows, std::int64_t columns) {
  Matrix result(matrix.size());
  for (std::int64_t i = 0; i < rows; ++i)
    for (std::int64_t j = 0; j < columns; ++j) result[at(j, rows, i)] = matrix[at(i, columns, j)];
  return result;
}

/// A product for the rows, one for the columns: linear and separable, and free of what runtimes mean by
/// resizing.
void resample(OnnxGraph& onnx, const Node& node, MatrixOf matrix) {
  const Shape& x = onnx.shape(node.inputs[0]);
  const Shape& y = onnx.shape(node.outputs[0]);
  const std::string rows = onnx.floats({y[2], x[2]}, matrix(y[2], x[2]));
  const std::string columns = onnx.floats({x[3], y[3]}, transposed(matrix(y[3], x[3]), y[3], x[3]));
  const std::string high = onnx.add("MatMul", {rows, onnx.tensor(node.inputs[0])});
  onnx.define(node.outputs[0], onnx.add("MatMul", {high, columns}));
}

}  // namespace

void adaptive_avg_pool_to_onnx(OnnxGraph& onnx, const Node& node) { resample(onnx, node, pooling); }
void resize_bilinear_to_onnx(OnnxGraph& onnx, const Node& node) { resample(onnx, node, bilinear); }

}  // namespace vkopple
