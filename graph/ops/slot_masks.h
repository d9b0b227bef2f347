#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Masks (B, K+1, H, W), background last: softmax over the K logits (K, B, H, W) of a pixel and a 0 for the
/// background. Row-major.
class SlotMasks : public Op {
 public:
  std::string_view name() const override { return "slot_masks"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value slot_masks(Value logits);

}  // namespace vkopple
