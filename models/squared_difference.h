#pragma once

#include "graph/ops/binary.h"

namespace vkopple {

/// (a − b)², of shapes that broadcast. Subtracted twice, as an op doesn't read one tensor twice.
inline Value squared_difference(Value a, Value b) { return mul(sub(a, b), sub(a, b)); }

}  // namespace vkopple
