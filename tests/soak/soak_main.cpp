#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>

#include "runtime/byte_text.h"
#include "runtime/device.h"
#include "tests/soak/soak.h"

// The program behind tools/soak: prints a line a round and, at the end, what grew.

namespace vkopple::test {
namespace {

constexpr uint64_t kResidentSlack = uint64_t{4} << 20;

uint64_t count_of(const VulkanObjects& objects, const char* kind) {
  const auto found = objects.counts.find(kind);
  return found == objects.counts.end() ? 0 : found->second;
}

uint64_t all_of(const VulkanObjects& objects) {
  uint64_t sum = 0;
  for (const auto& [kind, count] : objects.counts) sum += count;
  return sum;
}

void tell(const SoakPhase& phase) {
  const Holdings& held = phase.rounds.back();
  fmt::print("{:<30} {:>6} {:>12} {:>12} {:>6} {:>8} {:>8} {:>8}\n", phase.name,
             phase.rounds.size() * phase.each, byte_text(held.resident_bytes),
             byte_text(held.vulkan.memory_bytes), held.descriptors, count_of(held.vulkan, "command buffers"),
             count_of(held.vulkan, "descriptor sets"), all_of(held.vulkan));
  std::fflush(stdout);
}

int run(const std::filesystem::path& folder, uint64_t steps, uint64_t inferences) {
  const Device device({.selector = ""});
  fmt::print("{:<30} {:>6} {:>12} {:>12} {:>6} {:>8} {:>8} {:>8}\n", "work", "done", "resident", "device",
             "files", "commands", "sets", "objects");
  bool grew = false;
  for (const SoakPhase& phase :
       soak(device, {.folder = folder, .steps = steps, .inferences = inferences}, tell))
    for (const std::string& line : growth(phase, kResidentSlack)) {
      fmt::print("GREW {}\n", line);
      grew = true;
    }
  fmt::print("{}\n", grew ? "something grew" : "nothing grew");
  return grew ? 1 : 0;
}

}  // namespace
}  // namespace vkopple::test

/// FOLDER STEPS INFERENCES
int main(int count, char** arguments) {
  const auto number = [&](int i) {
    uint64_t value = 0;
    std::from_chars(arguments[i], arguments[i] + std::strlen(arguments[i]), value);
    return value;
  };
  try {
    if (count == 4) return vkopple::test::run(arguments[1], number(2), number(3));
    fmt::print(stderr, "usage: vkopple_soak FOLDER STEPS INFERENCES; tools/soak calls it\n");
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "vkopple_soak: {}\n", error.what());
    return 1;
  }
}
