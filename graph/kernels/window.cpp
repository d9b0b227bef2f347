#include "graph/kernels/window.h"

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct WindowPush {
  uint32_t vec4s;
  uint32_t from_height;
  uint32_t from_width;
  uint32_t to_height;
  uint32_t to_width;
  int32_t top;
  int32_t left;
  uint32_t accumulate;
};

}  // namespace

void copy_window(Recorder& recorder, const Operand& from, const Operand& to, int64_t top, int64_t left,
                 bool accumulate) {
  const WindowPush push{.vec4s = words(to) / 4,
                        .from_height = u32(from.shape()[2]),
                        .from_width = u32(from.shape()[3]),
                        .to_height = u32(to.shape()[2]),
                        .to_width = u32(to.shape()[3]),
                        .top = static_cast<int32_t>(top),
                        .left = static_cast<int32_t>(left),
                        .accumulate = accumulate};
  recorder.dispatch_flat("window", (push.vec4s + 3) / 4, {from.slice, to.slice}, push);
}

}  // namespace vkopple
