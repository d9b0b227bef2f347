#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "runtime/device_choice.h"
#include "runtime/error.h"
#include "runtime/instance.h"
#include "tools/command.h"

namespace vkopple {
namespace {

std::string_view type_name(DeviceType type) {
  switch (type) {
    case DeviceType::kDiscrete:
      return "discrete";
    case DeviceType::kIntegrated:
      return "integrated";
    case DeviceType::kVirtual:
      return "virtual";
    case DeviceType::kCpu:
      return "cpu";
    case DeviceType::kOther:
      return "other";
  }
  return "other";
}

/// "16x16x16" for m × n × k.
std::vector<std::string> matrix_texts(const Caps& caps) {
  std::vector<std::string> texts;
  for (const MatrixShape& s : caps.cooperative_matrices)
    texts.push_back(fmt::format("{}x{}x{}", s.m, s.n, s.k));
  return texts;
}

nlohmann::ordered_json to_json(size_t index, const Candidate& candidate) {
  const Caps& c = candidate.caps;
  return {{"index", index},
          {"name", c.name},
          {"type", type_name(c.type)},
          {"driver", c.driver},
          {"uuid", uuid_text(c.uuid)},
          {"memory_bytes", c.memory_bytes},
          {"max_storage_range", c.max_storage_range},
          {"max_texel_elements", c.max_texel_elements},
          {"subgroup_size", c.subgroup_size},
          {"cooperative_matrices", matrix_texts(c)},
          {"access", c.access == AccessPath::kTexel ? "texel" : "storage"},
          {"missing", candidate.missing}};
}

void print_table(const std::vector<Candidate>& candidates) {
  fmt::print("{:>5}  {:<10}  {:>8}  {:<40}  {}\n", "index", "type", "memory", "name", "driver");
  for (size_t i = 0; i < candidates.size(); ++i) {
    const Caps& c = candidates[i].caps;
    fmt::print("{:>5}  {:<10}  {:>4} GiB  {:<40}  {}\n", i, type_name(c.type), c.memory_bytes >> 30, c.name,
               c.driver);
    fmt::print("{:>5}  uuid {}{}\n", "", uuid_text(c.uuid),
               candidates[i].missing.empty()
                   ? ""
                   : fmt::format("; can't be used: lacks {}", fmt::join(candidates[i].missing, ", ")));
    if (!c.cooperative_matrices.empty())
      fmt::print("{:>5}  cooperative matrices {}\n", "", fmt::join(matrix_texts(c), ", "));
  }
}

}  // namespace

void add_devices(CLI::App& app) {
  CLI::App* command = app.add_subcommand("devices", "List the Vulkan devices and what they can do");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print JSON");
  command->footer("Example: vkopple devices --json");
  command->callback([json] {
    const Instance instance;
    const auto candidates = instance.candidates();
    if (*json) {
      auto list = nlohmann::ordered_json::array();
      for (size_t i = 0; i < candidates.size(); ++i) list.push_back(to_json(i, candidates[i]));
      fmt::print("{}\n", list.dump(2));
      return;
    }
    if (candidates.empty())
      throw Error("no Vulkan device; install a driver (mesa-vulkan-drivers has one for the CPU)");
    print_table(candidates);
  });
}

}  // namespace vkopple
