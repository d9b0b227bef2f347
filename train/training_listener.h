#pragma once

#include <string_view>

#include "train/step_record.h"

namespace vkopple {

/// Who is told how training goes.
class TrainingListener {
 public:
  virtual ~TrainingListener() = default;

  virtual void show(const StepRecord& record) = 0;
  /// Something to read about the run.
  virtual void say(std::string_view text) = 0;
};

}  // namespace vkopple
