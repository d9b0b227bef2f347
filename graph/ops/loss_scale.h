#pragma once

#include <string>
#include <vector>

#include "graph/graph.h"

namespace vkopple {

/// Scaling of the loss by a power of two, so that small gradients of activations survive float16 (Micikevicius
/// et al., "Mixed precision training", 2018, section 3.2).
struct LossScaleOptions {
  /// 2^8: the image loss is a sum over pixels, so that gradients of activations reach thousands, and training
  /// of the presets settles between 2^4 and 2^8.
  float initial = 256;
  float smallest = 1;
  float largest = 16777216;  ///< 2^24
  float interval = 1000;     ///< good steps in a row after which the scale doubles
};

/// What a step of training learns about the scale, on the device: whether every element of the gradients is
/// finite.
///   all finite:  factor ← 1 / scale;  good ← good + 1;  where good = interval: scale ← 2 scale, good ← 0
///   otherwise:   factor ← 0;  scale ← scale / 2;  good ← 0;  skipped ← skipped + 1
/// The scale stays within its limits. Adam multiplies gradients by the factor, and leaves everything as it is
/// where that is 0. Inputs: state (4), found (1, unsigned), then one or more flat gradients, each a multiple of
/// 4 long; state and found are updated. No outputs.
class LossScale : public Op {
 public:
  /// Elements of the state.
  enum Element : size_t { kScale, kGood, kSkipped, kFactor, kElements };

  explicit LossScale(const LossScaleOptions& options);
  std::string_view name() const override { return "loss_scale"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t) const override { return false; }
  bool mutates(size_t input) const override { return input < 2; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  LossScaleOptions options_;
};

inline constexpr const char* kLossScaleGroup = "loss_scale";
inline constexpr const char* kLossScaleState = "loss_scale/state";

/// Adds the update that watches the gradients of parameter groups, before those of Adam. Its state is the group
/// "loss_scale"; returns loss_scale/state, whose first element is the scale: write {initial, 0, 0, 0} at the
/// start.
Value loss_scale(Graph& graph, const std::vector<std::string>& groups, const LossScaleOptions& options = {});

}  // namespace vkopple
