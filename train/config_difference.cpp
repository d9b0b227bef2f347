#include "train/config_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace vkopple {
namespace {

using Ordered = nlohmann::ordered_json;

std::optional<ConfigDifference> compare(const Ordered& a, const Ordered& b, const std::string& key);

std::optional<ConfigDifference> compare_objects(const Ordered& a, const Ordered& b, const std::string& key) {
  const std::string prefix = key.empty() ? "" : key + ".";
  for (const auto& [name, value] : a.items()) {
    if (!b.contains(name)) return ConfigDifference{prefix + name, value.dump(), "absent"};
    if (auto found = compare(value, b.at(name), prefix + name)) return found;
  }
  for (const auto& [name, value] : b.items())
    if (!a.contains(name)) return ConfigDifference{prefix + name, "absent", value.dump()};
  return std::nullopt;
}

std::optional<ConfigDifference> compare_lists(const Ordered& a, const Ordered& b, const std::string& key) {
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    if (auto found = compare(a.at(i), b.at(i), fmt::format("{}[{}]", key, i))) return found;
  if (a.size() == b.size()) return std::nullopt;
  return ConfigDifference{key, fmt::format("a list of {}", a.size()), fmt::format("a list of {}", b.size())};
}

std::optional<ConfigDifference> compare(const Ordered& a, const Ordered& b, const std::string& key) {
  if (a.is_object() && b.is_object()) return compare_objects(a, b, key);
  if (a.is_array() && b.is_array()) return compare_lists(a, b, key);
  if (a == b) return std::nullopt;
  return ConfigDifference{key, a.dump(), b.dump()};
}

}  // namespace

std::optional<ConfigDifference> first_difference(const Config& first, const Config& second) {
  return compare(Ordered::parse(first.to_json()), Ordered::parse(second.to_json()), "");
}

}  // namespace vkopple
