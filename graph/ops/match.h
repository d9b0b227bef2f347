#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Which object is which (docs/model.md §3). Codes of two frames (B, K, C), of which the first `identity`
/// numbers count → log w (B, K, K), how far each object of b (rows) is each object of a, and q (B, K), how far
/// it is an object rather than background.
class Match : public Op {
 public:
  explicit Match(int64_t identity) : identity_(identity) {}
  std::string_view name() const override { return "match"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  int64_t identity_;
};

/// {log w, q}.
std::vector<Value> match(Value code_a, Value code_b, int64_t identity);

}  // namespace vkopple
