#include "graph/kernels/copy_runs.h"

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct CopyRunsPush {
  uint32_t units;
  uint32_t run;
  uint32_t from_stride;
  uint32_t from_begin;
  uint32_t to_stride;
  uint32_t to_begin;
  uint32_t accumulate;
};

}  // namespace

void copy_runs(Recorder& recorder, const Slice& from, const Slice& to, const Runs& r, bool accumulate) {
  if (r.count == 1 && !accumulate && from.storage == to.storage) {
    const uint64_t bytes = element_bytes(from.storage);
    recorder.copy(from.sub(r.from_begin * bytes, r.run * bytes), to.sub(r.to_begin * bytes, r.run * bytes));
    return;
  }
  const bool wide = (r.run | r.from_stride | r.from_begin | r.to_stride | r.to_begin) % 4 == 0;
  const uint64_t unit = wide ? 4 : 1;
  const CopyRunsPush push{.units = u32(r.count * r.run / unit),
                          .run = u32(r.run / unit),
                          .from_stride = u32(r.from_stride / unit),
                          .from_begin = u32(r.from_begin / unit),
                          .to_stride = u32(r.to_stride / unit),
                          .to_begin = u32(r.to_begin / unit),
                          .accumulate = accumulate};
  const bool even = (push.to_stride | push.to_begin) % 2 == 0;
  recorder.dispatch_units(wide ? "copy_runs.vec4s" : "copy_runs.words", push.units,
                          {.allowed = wide && even, .run = push.run}, {from, to, to}, push);
}

}  // namespace vkopple
