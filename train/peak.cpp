#include "train/peak.h"

#include <algorithm>
#include <chrono>

#include "runtime/device.h"
#include "runtime/recorder.h"

namespace vkopple {
namespace {

/// As the shader's block.
struct PeakPush {
  uint32_t turns;
  float factor, summand;
};

constexpr double kFlopPerTurn = 12 * 96 * 2;
/// Enough to fill a large GPU many times over; a CPU is full with a few.
constexpr uint64_t kInvocationsCpu = 4096;
constexpr uint64_t kInvocationsGpu = uint64_t{1} << 20;
constexpr double kLongEnough = 0.02;  // seconds, against which starting a run counts nothing
constexpr uint32_t kMostTurns = 1U << 16;
constexpr int kRuns = 5;

/// Seconds of the fastest of several runs.
double best_run(const Device& device, const Slice& y, uint64_t invocations, uint32_t turns) {
  Recorder recorder(device);
  recorder.dispatch_flat("fma_peak", invocations, {y}, PeakPush{turns, 0.5F, 1.0F});
  const auto commands = recorder.finish();
  double best = 1e30;
  for (int i = 0; i < kRuns; ++i) {
    const RunTimes times = commands->run();
    best = std::min(best, std::chrono::duration<double>(times.end - times.begin).count());
  }
  return best;
}

}  // namespace

double measure_peak_gflops(const Device& device) {
  const uint64_t invocations = device.caps().cpu() ? kInvocationsCpu : kInvocationsGpu;
  Arena arena(device, MemoryKind::kDevice, "peak");
  const Slice y = arena.allocate(invocations * sizeof(float));
  for (uint32_t turns = 1;; turns *= 4) {
    const double seconds = best_run(device, y, invocations, turns);
    if (seconds >= kLongEnough || turns >= kMostTurns)
      return static_cast<double>(invocations) * turns * kFlopPerTurn * 1e-9 / seconds;
  }
}

}  // namespace vkopple
