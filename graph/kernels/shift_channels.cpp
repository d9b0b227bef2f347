#include "graph/kernels/shift_channels.h"

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct ShiftChannelsPush {
  uint32_t vec4s;
  uint32_t pixels;
  uint32_t from_channels;
  uint32_t to_channels;
  int32_t shift;
  uint32_t accumulate;
};

}  // namespace

void shift_channels(Recorder& recorder, const Operand& from, const Operand& to, int64_t shift,
                    bool accumulate) {
  const ShiftChannelsPush push{.vec4s = words(to) / 4,
                               .pixels = u32(to.shape()[2] * to.shape()[3]),
                               .from_channels = u32(from.shape()[1]),
                               .to_channels = u32(to.shape()[1]),
                               .shift = static_cast<int32_t>(shift),
                               .accumulate = accumulate};
  recorder.dispatch_flat("shift_channels", (push.vec4s + 3) / 4, {from.slice, to.slice}, push);
}

}  // namespace vkopple
