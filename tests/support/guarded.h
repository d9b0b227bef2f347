#pragma once

#include <gtest/gtest.h>

#include <string>

#include "runtime/guarded_memory.h"
#include "runtime/recorder.h"

namespace vkopple::test {

/// Runs what was recorded with Bounds::kGuarded, and fails the test for every band that has changed.
inline void run_guarded(Recorder& recorder, GuardedMemory& memory) {
  recorder.finish()->run();
  for (const std::string& damage : memory.damage()) ADD_FAILURE() << damage;
}

}  // namespace vkopple::test
