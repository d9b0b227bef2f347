#include "graph/ops/rotation_vector.h"

namespace vkopple {

Value rotation_vector(Value rotation) {
  return rotation.graph().apply1(std::make_shared<RotationVector>(), {rotation});
}

}  // namespace vkopple
