#include "graph/ops/nearest_rotation.h"

namespace vkopple {

Value nearest_rotation(Value m) { return m.graph().apply1(std::make_shared<NearestRotation>(), {m}); }

}  // namespace vkopple
