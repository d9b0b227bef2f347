#include "train/profiler.h"

namespace vkopple {

Profiler::Profiler(const Caps& caps, std::filesystem::path path, int steps)
    : path_(std::move(path)), steps_(steps), first_(caps), others_(caps) {}

Trace* Profiler::begin_step() {
  if (written_) return nullptr;
  return seen_ == 0 ? &first_ : &others_;
}

void Profiler::end_step() {
  ++seen_;
  if (seen_ == steps_ + 1) finish();
}

void Profiler::finish() {
  if (written_ || seen_ == 0) return;
  (others_.empty() ? first_ : others_).write(path_);
  written_ = true;
}

}  // namespace vkopple
