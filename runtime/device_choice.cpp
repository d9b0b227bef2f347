#include "runtime/device_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <optional>

#include "runtime/error.h"

namespace vkopple {

std::string uuid_text(const std::array<uint8_t, 16>& uuid) {
  std::string text;
  for (size_t i = 0; i < uuid.size(); ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) text += '-';
    text += fmt::format("{:02x}", uuid[i]);
  }
  return text;
}

namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

int rank(DeviceType type) {
  switch (type) {
    case DeviceType::kDiscrete:
      return 0;
    case DeviceType::kIntegrated:
      return 1;
    case DeviceType::kVirtual:
      return 2;
    case DeviceType::kCpu:
      return 3;
    case DeviceType::kOther:
      return 4;
  }
  return 5;
}

std::string describe(std::span<const Candidate> candidates) {
  if (candidates.empty()) return "no Vulkan driver is installed (mesa-vulkan-drivers has one for the CPU)";
  std::vector<std::string> lines;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const auto& c = candidates[i];
    lines.push_back(
        fmt::format("{}: {}{}", i, c.caps.name,
                    c.missing.empty() ? "" : fmt::format(" (lacks {})", fmt::join(c.missing, ", "))));
  }
  return fmt::format("{}", fmt::join(lines, "; "));
}

size_t usable(std::span<const Candidate> candidates, size_t index, std::string_view selector) {
  if (!candidates[index].missing.empty())
    throw UsageError(fmt::format("--device {}: {} can't be used, it lacks {}", selector,
                                 candidates[index].caps.name, fmt::join(candidates[index].missing, ", ")));
  return index;
}

template <class Match>
std::optional<size_t> best(std::span<const Candidate> candidates, Match match) {
  std::optional<size_t> found;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const auto& c = candidates[i];
    if (!c.missing.empty() || !match(c)) continue;
    if (!found || rank(c.caps.type) < rank(candidates[*found].caps.type)) found = i;
  }
  return found;
}

}  // namespace

size_t choose_device(std::span<const Candidate> candidates, std::string_view selector) {
  const std::string want = lower(selector);
  if (want.empty() || want == "auto") {
    if (auto i = best(candidates, [](const Candidate&) { return true; })) return *i;
    throw Error(fmt::format("no usable Vulkan device: {}", describe(candidates)));
  }
  if (want == "cpu") {
    if (auto i = best(candidates, [](const Candidate& c) { return c.caps.cpu(); })) return *i;
    throw Error(fmt::format("--device cpu: no CPU device; install mesa-vulkan-drivers (there is: {})",
                            describe(candidates)));
  }
  size_t index = 0;
  const auto parsed = std::from_chars(want.data(), want.data() + want.size(), index);
  if (parsed.ec == std::errc() && parsed.ptr == want.data() + want.size()) {
    if (index < candidates.size()) return usable(candidates, index, selector);
    throw UsageError(fmt::format("--device {}: there are {} devices: {}", selector, candidates.size(),
                                 describe(candidates)));
  }
  for (size_t i = 0; i < candidates.size(); ++i)
    if (uuid_text(candidates[i].caps.uuid) == want) return usable(candidates, i, selector);
  const auto named = [&](const Candidate& c) { return lower(c.caps.name).find(want) != std::string::npos; };
  if (auto i = best(candidates, named)) return *i;
  for (size_t i = 0; i < candidates.size(); ++i)
    if (named(candidates[i])) return usable(candidates, i, selector);
  throw UsageError(fmt::format("--device {}: no such device; auto, cpu, an index, a name or a UUID of: {}",
                               selector, describe(candidates)));
}

std::string device_selector(std::string_view option) {
  if (!option.empty()) return std::string(option);
  const char* variable = std::getenv("VKOPPLE_DEVICE");
  return variable != nullptr && *variable != '\0' ? variable : "auto";
}

}  // namespace vkopple
