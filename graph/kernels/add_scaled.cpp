#include "graph/kernels/add_scaled.h"

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct AddScaledPush {
  uint32_t units;
  float scale;
  uint32_t accumulate;
};

}  // namespace

void add_scaled(Recorder& recorder, const Operand& from, const Operand& to, float scale, bool accumulate) {
  if (scale == 1.0F && !accumulate && from.spec.storage == to.spec.storage) {
    if (to.slice.overlaps(from.slice)) return;  // in place: it is there already
    recorder.copy(from.slice, to.slice);
    return;
  }
  const bool wide = words(to) % 4 == 0;
  const AddScaledPush push{words(to) / (wide ? 4 : 1), scale, accumulate};
  recorder.dispatch_flat(wide ? "add_scaled.vec4s" : "add_scaled.words", (push.units + 3) / 4,
                         {from.slice, to.slice}, push);
}

}  // namespace vkopple
