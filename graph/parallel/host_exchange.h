#pragma once

#include <functional>
#include <span>

#include "runtime/recorder.h"

namespace vkopple {

/// Records that the host changes floats where the recording has come to: it reads them from the device, runs
/// `change` on them and writes them back.
void record_change(Recorder& recorder, const Slice& floats, std::function<void(std::span<float>)> change);

}  // namespace vkopple
