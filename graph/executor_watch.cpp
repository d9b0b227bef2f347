#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "graph/executor.h"
#include "runtime/transfer.h"

namespace vkopple {
namespace {

/// Whether one of the numbers, as they lie in memory, has all bits of its exponent set.
template <class Word>
bool any_with(std::span<const std::byte> bytes, Word exponent) {
  for (size_t at = 0; at + sizeof(Word) <= bytes.size(); at += sizeof(Word)) {
    Word word = 0;
    std::memcpy(&word, bytes.data() + at, sizeof word);
    if ((word & exponent) == exponent) return true;
  }
  return false;
}

bool is_finite(const Device& device, const Operand& operand) {
  if (!operand || operand.spec.dtype != DType::kF32) return true;
  std::vector<std::byte> bytes(operand.spec.bytes());
  download(device, operand.slice, bytes);
  return operand.spec.storage == Storage::kFloat16 ? !any_with<uint16_t>(bytes, 0x7c00)
                                                   : !any_with<uint32_t>(bytes, 0x7f800000);
}

}  // namespace

std::optional<std::string> Executor::find_not_finite() {
  std::optional<std::string> found;
  const auto watcher = [&](const char* pass, size_t count) {
    return [&found, this, pass, count](const Node& node, size_t number, std::span<const Operand> given) {
      if (found) return;
      if (std::all_of(given.begin(), given.end(), [&](const Operand& o) { return is_finite(*device_, o); }))
        return;
      found = fmt::format("{}{}, op {} of {} in {}", node.op->name(),
                          node.scope.empty() ? "" : " of " + node.scope, number + 1, count, pass);
    };
  };
  recorded_forward(false, watcher("forward", graph_->nodes().size()))->run();
  // Also where the place is found: peers may be without a find and wait in backward.
  if (clear_) clear_->run();
  if (loss_) recorded_backward(false, watcher("backward", plan_.backward.steps.size()))->run();
  return found;
}

}  // namespace vkopple
