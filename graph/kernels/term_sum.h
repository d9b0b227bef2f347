#pragma once

#include "graph/kernels/strided_sum.h"

namespace vkopple {

/// The last part of a loss: `count` terms in scratch memory, and their sum.
class TermSum {
 public:
  explicit TermSum(uint64_t count) : count_(count), sum_(sum_of_all(count)) {}
  uint64_t count() const { return count_; }
  uint64_t scratch_bytes() const { return aligned(count_ * 4) + aligned(sum_.scratch_bytes()); }
  /// Where the terms are written to.
  Slice terms(const Slice& scratch) const { return scratch.sub(0, count_ * 4); }
  /// loss = scale · Σ terms.
  void record(Recorder& recorder, const Slice& scratch, const Slice& loss, float scale) const;

 private:
  uint64_t count_;
  StridedSum sum_;
};

}  // namespace vkopple
