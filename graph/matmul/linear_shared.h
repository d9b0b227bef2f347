#pragma once

#include "graph/matmul/linear_push.h"
#include "graph/matmul/linear_tile.h"
#include "runtime/recorder.h"

namespace vkopple {

/// The kernel of GPUs for y = x wᵀ + b and its gradients: tiles of both operands lie in shared memory, where
/// all of a workgroup's invocations read them. Any sizes. Terms add up in the plain kernels' order.
enum class LinearPart {
  kForward,  ///< y from x and w
  kDx,       ///< dx from dy and w
  kDw,       ///< dw from dy and x
};

struct LinearOperands {
  Slice a;
  Slice b;
  Slice bias;  ///< of kForward; may be empty
  Slice out;
};

void record_linear_shared(Recorder& recorder, LinearPart part, const LinearPush& push,
                          const LinearOperands& operands, const LinearTile& tile);
/// With the tile estimated to be fastest.
void record_linear_shared(Recorder& recorder, LinearPart part, const LinearPush& push,
                          const LinearOperands& operands);

}  // namespace vkopple
