#include "graph/op.h"

#include <fmt/format.h>

#include "runtime/error.h"

namespace vkopple {

void Op::require(bool condition, const std::string& message) const {
  if (!condition) throw Error(fmt::format("[{}] {}", name(), message));
}

std::vector<TensorSpec> infer_stored(const Op& op, std::span<const TensorSpec> x, Storage activations) {
  std::vector<TensorSpec> plain;
  for (const TensorSpec& spec : x) plain.push_back(stored_as(spec, Storage::kFloat32));
  std::vector<TensorSpec> outputs = op.infer(plain);
  for (TensorSpec& spec : outputs) spec = stored_as(spec, activations);
  return outputs;
}

}  // namespace vkopple
