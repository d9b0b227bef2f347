#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "graph/graph.h"
#include "train/stored_tensor.h"

namespace vkopple {

namespace onnx {
class GraphProto;
}

using OnnxAttribute = std::variant<std::int64_t, float, std::vector<std::int64_t>>;
using OnnxAttributes = std::vector<std::pair<std::string_view, OnnxAttribute>>;

/// Writes a graph's values as tensors of ONNX: weights, inputs and views when they are first asked for, what
/// nodes give when their translators say. All tensors are row-major; layouts are left behind.
class OnnxGraph {
 public:
  /// `weights` by the names of the graph's parameters and states. All must outlive this.
  OnnxGraph(const Graph& graph, const std::map<std::string, StoredTensor>& weights, onnx::GraphProto& out);

  const Shape& shape(int value) const { return graph_.info(value).spec.shape; }
  /// The tensor of a value. Throws Error for one that is neither given nor a view or weight.
  std::string tensor(int value);
  /// From now on `tensor` is what the graph calls `value`.
  void define(int value, const std::string& tensor) { tensors_[value] = tensor; }
  /// The values of a parameter or state. Throws Error where there is none.
  const StoredTensor& weight(int value) const;

  /// Appends a node and returns its (one) output. Names begin with the scope.
  std::string add(std::string_view type, const std::vector<std::string>& inputs,
                  const OnnxAttributes& attributes = {});
  /// Constants.
  std::string floats(const StoredShape& shape, std::span<const float> values);
  std::string ints(std::span<const std::int64_t> values);
  std::string scalar(float value) { return floats({}, std::span(&value, 1)); }

  // What several translators are made of.
  std::string reshape(const std::string& x, const StoredShape& shape);
  /// Entries `begin` to `begin` + `count` - 1 of an axis.
  std::string slice(const std::string& x, std::int64_t axis, std::int64_t begin, std::int64_t count);
  /// scale · x + offset
  std::string affine(const std::string& x, float scale, float offset);

  void set_scope(const std::string& scope) { scope_ = scope; }

 private:
  void constant(const std::string& name, const TensorView& values);
  std::string fresh(std::string_view kind);
  std::string view(int value);

  const Graph& graph_;
  const std::map<std::string, StoredTensor>& weights_;
  onnx::GraphProto& out_;
  std::map<int, std::string> members_;  ///< names of parameters and states, by value
  std::map<int, std::string> tensors_;
  std::string scope_;
  std::size_t count_ = 0;
};

/// The shape as ONNX has it.
StoredShape stored(const Shape& shape);

}  // namespace vkopple
