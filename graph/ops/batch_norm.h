#pragma once

#include "graph/graph.h"
#include "graph/norm/normalise.h"
#include "graph/parallel/peers.h"

namespace vkopple {

struct BatchNormOptions {
  float eps = 1e-5F;
  float momentum = 0.1F;   ///< of the running averages
  int64_t groups = 1;      ///< runs of samples, each with statistics of its own
  bool training = true;    ///< false: running statistics, and no dropout
  float slope = 1;         ///< of a LeakyReLU before the norm, in (0, 1]; 1: none
  float dropout = 0;       ///< rate of dropout after the norm, as the op dropout
  uint32_t stream = 0;     ///< of dropout
  Peers* peers = nullptr;  ///< whose batches share statistics in training; null: every process has its own
};

/// y = dropout((leaky(x) − mean) / √(variance + eps) · gamma + beta), per channel.
/// Inputs: x (N, C, H, W) NC4HW4; gamma, beta, running_mean, running_var (C) row-major; random, u32 (2), where
/// something is dropped. Training takes mean and biased variance over (N / groups, H, W) of each of the groups,
/// and moves the running averages by every group in order: running += momentum · (batch − running), with the
/// variance's n / (n − 1) (taken as 1 where n = 1, which PyTorch refuses).
class BatchNorm : public Op {
 public:
  explicit BatchNorm(const BatchNormOptions& options);
  std::string_view name() const override { return "batch_norm"; }
  const BatchNormOptions& options() const { return options_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input < 3; }
  bool mutates(size_t input) const override { return options_.training && (input == 3 || input == 4); }
  int in_place() const override { return 0; }
  int gradient_in_place() const override { return 0; }
  bool recomputes() const override { return true; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  /// Applies the statistics that forward saved.
  void record_again(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  bool drops() const { return options_.training && options_.dropout > 0; }
  bool shares() const { return options_.training && several(options_.peers); }
  Normalise normalise(const Shape& x, const Caps& caps) const;

  BatchNormOptions options_;
};

/// `random` may be empty where options drop nothing.
Value batch_norm(Value x, Value gamma, Value beta, Value running_mean, Value running_var, Value random,
                 const BatchNormOptions& options);

}  // namespace vkopple
