#include "graph/kernels/circular.h"

namespace vkopple {
namespace {

struct CircularPush {
  uint32_t count;
  uint32_t bins;
  uint32_t own_step;  ///< bins that the other function's index moves by, as this one's index grows by 1
  uint32_t step;      ///< and as the summed index does; a step back is bins - 1 forward
  uint32_t accumulate;
};

}  // namespace

void circular_log_sum(Recorder& recorder, const Slice& a, const Slice& b, const Slice& y, const Circle& circle,
                      Direction direction) {
  const uint32_t step = direction == Direction::kForward ? 1 : circle.bins - 1;
  const CircularPush push{circle.rows * circle.bins, circle.bins, 1, step, 0};
  recorder.dispatch_flat("circular.forward", push.count, {a, b, y}, push);
}

void circular_log_sum_gradient(Recorder& recorder, const CircularGradient& io, const Circle& circle,
                               Direction direction) {
  // Correlation: a[i] goes with b[t + i], b[j] with a[j - t]. Convolution: a[i] with b[t - i], b[j] with a[t -
  // j].
  const bool correlation = direction == Direction::kForward;
  const uint32_t back = circle.bins - 1;
  const CircularPush push{.count = circle.rows * circle.bins,
                          .bins = circle.bins,
                          .own_step = correlation ? 1 : back,
                          .step = correlation && !io.of_a ? back : 1,
                          .accumulate = io.accumulate};
  recorder.dispatch_flat("circular.backward", push.count,
                         {io.of_a ? io.a : io.b, io.of_a ? io.b : io.a, io.y, io.dy, io.to}, push);
}

}  // namespace vkopple
