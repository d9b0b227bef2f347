#include "graph/kernels/log_normalise.h"

namespace vkopple {
namespace {

struct LogNormalisePush {
  uint32_t rows;
  uint32_t length;
};

}  // namespace

void log_normalise(Recorder& recorder, const Slice& y, uint32_t rows, uint32_t length) {
  recorder.dispatch_flat("log_normalise.forward", rows, {y}, LogNormalisePush{rows, length});
}

void log_normalise_gradient(Recorder& recorder, const Slice& y, const Slice& dy, const Slice& du, uint32_t rows,
                            uint32_t length) {
  recorder.dispatch_flat("log_normalise.backward", rows, {y, dy, du}, LogNormalisePush{rows, length});
}

}  // namespace vkopple
