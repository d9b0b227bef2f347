#include "graph/kernels/term_sum.h"

namespace vkopple {

void TermSum::record(Recorder& recorder, const Slice& scratch, const Slice& loss, float scale) const {
  const uint64_t bytes = sum_.scratch_bytes();
  const Slice stage = bytes == 0 ? Slice{} : scratch.sub(aligned(count_ * 4), bytes);
  sum_.record(recorder, terms(scratch), {}, loss, stage, scale, false);
}

}  // namespace vkopple
