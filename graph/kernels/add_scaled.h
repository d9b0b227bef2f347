#pragma once

#include "graph/op.h"

namespace vkopple {

/// to = scale · from, or added to what is there; tensors of one specification. How a gradient passes through a
/// sum.
void add_scaled(Recorder& recorder, const Operand& from, const Operand& to, float scale, bool accumulate);

}  // namespace vkopple
