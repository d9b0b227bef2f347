#pragma once

#include "runtime/recorder.h"

namespace vkopple {

/// Rows of functions on the bins of a turn; bins count modulo their number.
struct Circle {
  uint32_t rows;
  uint32_t bins;
};

enum class Direction { kForward, kBackward };

/// Circular correlation (kForward: y[t] = logsumexp over i of a[i] + b[t + i]) or convolution (kBackward:
/// b[t − i]) in the log domain.
void circular_log_sum(Recorder& recorder, const Slice& a, const Slice& b, const Slice& y, const Circle& circle,
                      Direction direction);

/// Their gradient by a or by b, from y and its gradient.
struct CircularGradient {
  Slice a;
  Slice b;
  Slice y;
  Slice dy;
  Slice to;  ///< the gradient of a or of b
  bool of_a;
  uint32_t accumulate;
};
void circular_log_sum_gradient(Recorder& recorder, const CircularGradient& io, const Circle& circle,
                               Direction direction);

}  // namespace vkopple
