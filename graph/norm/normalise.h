#pragma once

#include "graph/op.h"
#include "graph/random/dropout_rate.h"

namespace vkopple {

/// What surrounds a normalisation, fused with it: y = dropout(norm(leaky(x))).
struct NormSurround {
  float slope = 1;  ///< of the LeakyReLU before; 1: none
  DropoutRate dropout = {};
  bool drops = false;
  uint32_t stream = 0;
};

/// How the reductions share their work; laid out as shaders/include/norm_strips.glsl has it.
struct NormStrips {
  uint32_t items;   ///< samples of a group times pixels
  uint32_t strips;  ///< of each (group, channel block)
  uint32_t lanes;   ///< log2 of a strip's stride
  uint32_t each;    ///< items of a strip, at most
  uint32_t blocks;  ///< of 4 channels
  uint32_t groups;
  uint32_t channels;
};

/// The passes that batch and layer normalisation share, over x (N, C, H, W) in NC4HW4 whose samples form
/// `groups` runs of equal length. Statistics are per group and channel; layer normalisation has a group for
/// every sample and joins its channels in the second stage. Both second stages are the ops' own kernels; they
/// read `partials` and make tables [group][block][4] of vec4 (shaders/norm).
class Normalise {
 public:
  Normalise(const Shape& x, int64_t groups, const NormSurround& surround, const Caps& caps);

  const NormStrips& strips() const { return strips_; }
  /// Room for what either first stage writes.
  uint64_t partial_bytes() const;
  /// What record_reduce() writes.
  uint64_t sum_bytes() const;
  TensorSpec table() const;
  /// Invocations of a second stage's workgroup, at most 64.
  uint32_t finish_workgroup() const { return finish_workgroup_; }

  /// Means and squares of leaky(x) by strip.
  void record_statistics(Recorder& recorder, const Slice& x, const Slice& partials) const;
  /// `random` may be empty where nothing is dropped.
  void record_apply(Recorder& recorder, const Slice& random, const Slice& x, const Slice& table,
                    const Slice& y) const;
  /// Sums of dy' and of dy' (leaky(x) − mean) by strip, dy' = dy through dropout.
  void record_reduce(Recorder& recorder, const Slice& random, const Slice& x, const Slice& dy,
                     const Slice& table, const Slice& partials) const;
  void record_apply_backward(Recorder& recorder, const Slice& random, const Slice& x, const Slice& coefficients,
                             const Slice& dy, const Slice& dx, uint32_t accumulate) const;

 private:
  struct WalkPush;
  struct ApplyPush;
  WalkPush walk_push() const;
  ApplyPush apply_push(uint32_t accumulate) const;
  Groups strip_groups() const;
  void dispatch_apply(Recorder& recorder, const char* shader, std::initializer_list<Slice> bindings,
                      uint32_t accumulate) const;

  NormStrips strips_;
  NormSurround surround_;
  uint32_t samples_;
  uint32_t pixels_;
  uint32_t per_group_;
  uint32_t lanes_;             ///< log2 of the stride within a sample, of the apply passes
  uint32_t apply_each_;        ///< pixels of an invocation in the apply passes
  uint32_t strip_workgroup_;   ///< invocations
  uint32_t finish_workgroup_;  ///< invocations
  uint32_t flat_workgroup_;    ///< invocations
};

}  // namespace vkopple
