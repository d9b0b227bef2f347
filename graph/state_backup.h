#pragma once

#include <memory>
#include <vector>

#include "runtime/buffer.h"
#include "runtime/recorder.h"

namespace vkopple {

/// A copy of tensors on a device, within its memory, to take back what is done to them.
class StateBackup {
 public:
  /// The tensors must outlive it.
  StateBackup(const Device& device, const std::vector<Slice>& tensors);

  void keep() const { keep_->run(); }
  /// To what they were at the last keep().
  void restore() const { restore_->run(); }

 private:
  Arena arena_;
  std::unique_ptr<Commands> keep_;
  std::unique_ptr<Commands> restore_;
};

}  // namespace vkopple
