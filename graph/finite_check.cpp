#include "graph/finite_check.h"

#include "graph/kernels/words.h"
#include "runtime/transfer.h"

namespace vkopple {
namespace {

/// Vectors that one invocation looks at.
constexpr uint32_t kVectorsEach = 16;

struct LookPush {
  uint32_t vectors;
};

}  // namespace

void record_finite_check(Recorder& recorder, const Slice& x, const Slice& found) {
  const LookPush push{u32(x.bytes / (4 * sizeof(float)))};
  recorder.dispatch_flat("loss_scale.look", (push.vectors + kVectorsEach - 1) / kVectorsEach, {x, found}, push);
}

FiniteCheck::FiniteCheck(const Device& device, const std::vector<Slice>& tensors)
    : device_(&device),
      arena_(device, MemoryKind::kHost, "check of finite numbers", sizeof(uint32_t)),
      found_(arena_.allocate(sizeof(uint32_t))) {
  Recorder recorder(device);
  recorder.fill(found_);
  for (const Slice& x : tensors) record_finite_check(recorder, x, found_);
  look_ = recorder.finish();
}

bool FiniteCheck::all_finite() const {
  look_->run();
  return download_values<uint32_t>(*device_, found_).at(0) == 0;
}

}  // namespace vkopple
