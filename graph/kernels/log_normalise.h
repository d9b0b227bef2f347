#pragma once

#include "runtime/recorder.h"

namespace vkopple {

/// Rows of `length` floats, in place: y ← y − ln Σ exp y.
void log_normalise(Recorder& recorder, const Slice& y, uint32_t rows, uint32_t length);
/// The gradient before normalising from the one after: du = dy − exp(y) Σ dy over the row.
void log_normalise_gradient(Recorder& recorder, const Slice& y, const Slice& dy, const Slice& du, uint32_t rows,
                            uint32_t length);

}  // namespace vkopple
