#pragma once

#include "graph/graph.h"
#include "graph/random/dropout_rate.h"

namespace vkopple {

/// y = x · mask / (1 − rate), where each word of x's storage is kept with probability 1 − rate. The mask is a
/// hash of (seed, step, stream, word), so backward computes it again and nothing is saved.
/// Inputs: x, any shape and layout; random, u32 (2) = {seed, step}.
class Dropout : public Op {
 public:
  /// rate in [0, 1). Calls with different streams get independent masks.
  Dropout(float rate, uint32_t stream);
  std::string_view name() const override { return "dropout"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input == 0; }
  int in_place() const override { return 0; }
  int gradient_in_place() const override { return 0; }
  bool recomputes() const override { return true; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  void record(Recorder& recorder, const Operand& from, const Operand& random, const Operand& to,
              uint32_t accumulate) const;

  float rate_;
  uint32_t stream_;
};

/// x itself where rate is 0.
Value dropout(Value x, Value random, float rate, uint32_t stream);

}  // namespace vkopple
