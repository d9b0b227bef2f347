#pragma once

#include "graph/op.h"

namespace vkopple {

/// Of NC4HW4 tensors equal but for height and width: to(n, c, y, x) = from(n, c, y + top, x + left), zero
/// outside of `from`; added to what is there where `accumulate`.
void copy_window(Recorder& recorder, const Operand& from, const Operand& to, int64_t top, int64_t left,
                 bool accumulate);

}  // namespace vkopple
