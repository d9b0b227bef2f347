#include "graph/op.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr size_t kMaskBits = 32;

}  // namespace

uint32_t Backward::wants_mask() const {
  uint32_t mask = 0;
  for (size_t i = 0; i < std::min(dx.size(), kMaskBits); ++i) mask |= (wants(i) ? 1U : 0U) << i;
  return mask;
}

uint32_t Backward::accumulates_mask() const {
  uint32_t mask = 0;
  for (size_t i = 0; i < std::min(accumulate.size(), kMaskBits); ++i) mask |= accumulates(i) << i;
  return mask;
}

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
