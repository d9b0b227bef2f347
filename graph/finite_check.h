#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "runtime/buffer.h"
#include "runtime/recorder.h"

namespace vkopple {

/// Has `found`, one unsigned word, set where one of the floats of `x`, a multiple of 4 of them, is infinite or
/// no number, and left as it is otherwise.
void record_finite_check(Recorder& recorder, const Slice& x, const Slice& found);

/// Tells whether tensors on a device hold finite numbers alone. One pass over them, and one word for the host
/// to read.
class FiniteCheck {
 public:
  /// Of float32, each a multiple of 4 long. They must outlive it.
  FiniteCheck(const Device& device, const std::vector<Slice>& tensors);

  /// As they are now.
  bool all_finite() const;

 private:
  const Device* device_;
  Arena arena_;
  Slice found_;
  std::unique_ptr<Commands> look_;
};

}  // namespace vkopple
