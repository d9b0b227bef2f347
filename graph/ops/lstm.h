#pragma once

#include "graph/graph.h"

namespace vkopple {

/// One LSTM layer whose input is the same vector at every step, from a state of zeros. Gates in PyTorch's order
/// i f g o: a = x w_ihᵀ + b_ih + h w_hhᵀ + b_hh; c = σ(a_f) c + σ(a_i) tanh(a_g); h = σ(a_o) tanh(c).
/// Inputs: x (B, I), w_ih (4H, I), w_hh (4H, H), b_ih (4H), b_hh (4H). Output: h of every step (B, steps, H).
class Lstm : public Op {
 public:
  explicit Lstm(int64_t steps);
  std::string_view name() const override { return "lstm"; }
  int64_t steps() const { return steps_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  int64_t steps_;
};

Value lstm(Value x, Value w_ih, Value w_hh, Value b_ih, Value b_hh, int64_t steps);

}  // namespace vkopple
