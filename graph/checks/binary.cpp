#include "graph/ops/binary.h"

#include <algorithm>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

double combined(BinaryKind kind, double a, double b) {
  if (kind == BinaryKind::kAdd) return a + b;
  return kind == BinaryKind::kSub ? a - b : a * b;
}

/// The value at the indices of a larger space, axes aligned at the innermost one.
double repeated(const HostTensor& x, const std::vector<int64_t>& indices) {
  int64_t at = 0;
  for (size_t i = 0; i < x.shape.rank(); ++i) {
    const int64_t index = indices[indices.size() - x.shape.rank() + i];
    at = at * x.shape[i] + (x.shape[i] == 1 ? 0 : index);
  }
  return x.values[static_cast<size_t>(at)];
}

HostTensors reference(BinaryKind kind, const HostTensors& x, const Shape& out) {
  HostTensor y(out);
  std::vector<int64_t> indices(out.rank(), 0);
  for (double& v : y.values) {
    v = combined(kind, repeated(x[0], indices), repeated(x[1], indices));
    for (size_t axis = out.rank(); axis-- > 0;) {
      if (++indices[axis] < out[axis]) break;
      indices[axis] = 0;
    }
  }
  return {y};
}

}  // namespace

void check_binary(CheckList& list) {
  const std::vector<std::pair<TensorSpec, TensorSpec>> pairs = {
      {row_major({1}), row_major({1})},
      {row_major({3, 5, 7}), row_major({3, 5, 7})},
      {row_major({4, 65}), row_major({4, 65})},
      {channels4({2, 3, 5, 7}), channels4({2, 3, 5, 7})},
      {channels4({2, 7, 18, 19}), channels4({2, 7, 18, 19})},
      {row_major({2, 1, 3, 5}), row_major({2, 4, 1, 1})},
      {row_major({7}), row_major({3, 5, 7})},
      {row_major({2, 3, 2, 1, 3}), row_major({3, 1, 4, 1})},
      {row_major({1}), row_major({1361})},
      {row_major({2, 1, 33}), row_major({2, 31, 33})},
      {row_major({5, 1}), row_major({1, 1})},
      {row_major({2, 3, 26, 25}), row_major({2, 3, 1, 1})},
  };
  for (BinaryKind kind : {BinaryKind::kAdd, BinaryKind::kSub, BinaryKind::kMul})
    for (const auto& [a, b] : pairs) {
      const auto op = std::make_shared<Binary>(kind);
      const Shape out = op->infer(std::vector<TensorSpec>{a, b})[0].shape;
      list.push_back({.label = a.shape.text() +
                               (kind == BinaryKind::kAdd   ? " + "
                                : kind == BinaryKind::kSub ? " - "
                                                           : " * ") +
                               b.shape.text(),
                      .op = op,
                      .inputs = {a, b},
                      .reference = [kind, out](const HostTensors& x) { return reference(kind, x, out); }});
    }
}

}  // namespace vkopple
