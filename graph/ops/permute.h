#pragma once

#include <array>
#include <utility>

#include "graph/graph.h"

namespace vkopple {

/// Axes in another order: y's axis i is x's axis order[i]. Row-major floats of any rank.
class Permute : public Op {
 public:
  explicit Permute(std::vector<size_t> order) : order_(std::move(order)) {}
  std::string_view name() const override { return "permute"; }
  const std::vector<size_t>& order() const { return order_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  std::vector<size_t> order_;
};

Value permute(Value x, std::vector<size_t> order);

}  // namespace vkopple
