#include "graph/op.h"

#include <fmt/format.h>

#include "runtime/error.h"

namespace vkopple {

void Op::require(bool condition, const std::string& message) const {
  if (!condition) throw Error(fmt::format("[{}] {}", name(), message));
}

}  // namespace vkopple
