#include "graph/ops/euler_rotation.h"

namespace vkopple {

Value euler_rotation(Value pairs) { return pairs.graph().apply1(std::make_shared<EulerRotation>(), {pairs}); }

}  // namespace vkopple
