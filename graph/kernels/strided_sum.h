#pragma once

#include <array>
#include <vector>

#include "graph/op.h"

namespace vkopple {

/// Sums of a tensor, or of the product of two, over some axes of a space that both are walked along with
/// strides: a stride of 0 repeats a tensor along that axis. Long sums go in two stages; the order is always the
/// same.
class StridedSum {
 public:
  struct Axis {
    int64_t size;
    bool summed;
    int64_t x_stride;  ///< words
    int64_t w_stride;  ///< words; 0 where there is no w
  };
  /// axes: outermost first, at most 6. The result is row-major over those that are not summed.
  explicit StridedSum(const std::vector<Axis>& axes);

  uint64_t scratch_bytes() const;
  /// y = scale · Σ x (· w), or added to what y holds. w may be empty. scratch: scratch_bytes() bytes.
  void record(Recorder& recorder, const Slice& x, const Slice& w, const Slice& y, const Slice& scratch,
              float scale, bool accumulate) const;

 private:
  std::vector<Axis> kept_;
  std::vector<Axis> summed_;
  uint64_t kept_elements_ = 1;
  uint64_t summed_elements_ = 1;
  uint64_t strip_ = 1;
  uint64_t strips_ = 1;
};

/// Strides in words of a row-major tensor walked along `space`, to which it is broadcast as numpy does: axes
/// align at the innermost one, and an axis of size 1 repeats.
std::vector<int64_t> broadcast_strides(const Shape& tensor, const Shape& space);

/// The sum of `count` consecutive words, times scale.
StridedSum sum_of_all(uint64_t count);

}  // namespace vkopple
