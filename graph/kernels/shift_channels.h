#pragma once

#include "graph/op.h"

namespace vkopple {

/// Of NC4HW4 tensors equal but for their channels: to(n, c, y, x) = from(n, c + shift, y, x), zero where `from`
/// has no such channel; added to what is there where `accumulate`.
void shift_channels(Recorder& recorder, const Operand& from, const Operand& to, int64_t shift, bool accumulate);

}  // namespace vkopple
