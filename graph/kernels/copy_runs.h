#pragma once

#include "runtime/recorder.h"

namespace vkopple {

/// `count` runs of consecutive words, equally spaced on both sides. In words.
struct Runs {
  uint64_t count = 1;
  uint64_t run = 0;
  uint64_t from_stride = 0;
  uint64_t from_begin = 0;
  uint64_t to_stride = 0;
  uint64_t to_begin = 0;
};

/// Copies the runs, or adds them to what is there.
void copy_runs(Recorder& recorder, const Slice& from, const Slice& to, const Runs& runs, bool accumulate);

}  // namespace vkopple
