#pragma once

#include "graph/graph.h"
#include "graph/parallel/peers.h"

namespace vkopple {

/// What all processes have, one after the other in the order of ranks: x (B, ...) row-major → (count · B, ...).
/// Backward gives this process's part times their number: each process computes the whole of what follows, and
/// the mean over processes is taken of gradients of parts.
class GatherBatch : public Op {
 public:
  /// `peers` must outlive it; null: this process alone.
  explicit GatherBatch(Peers* peers) : peers_(peers) {}
  std::string_view name() const override { return "gather_batch"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  int count() const { return peers_ == nullptr ? 1 : peers_->count(); }
  /// This process's part of all.
  Slice own_part(const Slice& all) const;

  Peers* peers_;
};

/// x itself where there is one process.
Value gather_batch(Value x, Peers* peers);

}  // namespace vkopple
