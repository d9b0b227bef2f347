#include "graph/ops/vector_rotation.h"

namespace vkopple {

Value vector_rotation(Value vector) {
  return vector.graph().apply1(std::make_shared<VectorRotation>(), {vector});
}

}  // namespace vkopple
