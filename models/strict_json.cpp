#include "models/strict_json.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <utility>

#include "models/quote_json.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

using nlohmann::json;

constexpr std::size_t kDeepest = 32;

/// Watches a parse: nlohmann keeps the last of equal keys without a word, so they are caught here.
class DuplicateGuard {
 public:
  explicit DuplicateGuard(std::string_view origin) : origin_(origin) {}

  bool operator()(json::parse_event_t event, const json& parsed) {
    switch (event) {
      case json::parse_event_t::object_start:
        open(true);
        break;
      case json::parse_event_t::array_start:
        open(false);
        break;
      case json::parse_event_t::object_end:
      case json::parse_event_t::array_end:
        levels_.pop_back();
        break;
      case json::parse_event_t::key:
        add(parsed.get_ref<const std::string&>());
        break;
      case json::parse_event_t::value:
        break;
    }
    return true;
  }

 private:
  struct Level {
    std::set<std::string> keys;
    std::string last;
    bool is_object = true;
  };

  void open(bool is_object) {
    if (levels_.size() == kDeepest) {
      throw Error(fmt::format("{}: nested deeper than {} levels; this is no configuration", origin_, kDeepest));
    }
    levels_.push_back({{}, {}, is_object});
  }

  void add(const std::string& key) {
    Level& level = levels_.back();
    level.last = printable(key);
    if (level.keys.insert(key).second) return;
    std::vector<std::string> path;
    for (const Level& l : levels_) {
      if (l.is_object) path.push_back(l.last);
    }
    throw Error(fmt::format("{}: key {} appears twice; keep one", origin_, fmt::join(path, ".")));
  }

  std::string_view origin_;
  std::vector<Level> levels_;
};

}  // namespace

json parse_strict_json(std::string_view text, std::string_view origin) {
  DuplicateGuard guard(origin);
  try {
    return json::parse(text,
                       [&guard](int, json::parse_event_t event, json& parsed) { return guard(event, parsed); });
  } catch (const json::exception& problem) {
    std::string_view what = problem.what();
    if (const auto bracket = what.find("] "); bracket != what.npos) what.remove_prefix(bracket + 2);
    throw Error(fmt::format("{}: not valid JSON: {}", origin, what));
  }
}

JsonObject::JsonObject(const json& value, std::string origin, std::string path)
    : value_(&value), origin_(std::move(origin)), path_(std::move(path)) {
  if (value.is_object()) return;
  throw Error(fmt::format("{}: {} is {}; give an object {{...}}", origin_, path_.empty() ? "the text" : path_,
                          quote_json(value)));
}

std::string JsonObject::full(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void JsonObject::refuse(std::string_view key, std::string_view problem) const {
  throw Error(fmt::format("{}: {} {}", origin_, full(key), problem));
}

const json* JsonObject::find(std::string_view key) {
  known_.emplace_back(key);
  const auto found = value_->find(key);
  return found == value_->end() ? nullptr : &*found;
}

void JsonObject::integer(std::string_view key, std::int64_t& value, std::int64_t lowest, std::int64_t highest) {
  const json* found = find(key);
  if (found == nullptr) return;
  const bool fits =
      found->is_number_integer() &&
      (!found->is_number_unsigned() || found->get<std::uint64_t>() <= static_cast<std::uint64_t>(INT64_MAX));
  if (!fits || found->get<std::int64_t>() < lowest || found->get<std::int64_t>() > highest) {
    refuse(key, fmt::format("is {}; give a whole number from {} to {}", quote_json(*found), lowest, highest));
  }
  value = found->get<std::int64_t>();
}

void JsonObject::integer(std::string_view key, int& value, int lowest, int highest) {
  std::int64_t wide = value;
  integer(key, wide, std::int64_t{lowest}, std::int64_t{highest});
  value = static_cast<int>(wide);
}

void JsonObject::number(std::string_view key, double& value, double lowest, double highest) {
  const json* found = find(key);
  if (found == nullptr) return;
  if (!found->is_number() || !(found->get<double>() >= lowest && found->get<double>() <= highest)) {
    refuse(key, fmt::format("is {}; give a number from {} to {}", quote_json(*found), lowest, highest));
  }
  value = found->get<double>();
}

void JsonObject::boolean(std::string_view key, bool& value) {
  const json* found = find(key);
  if (found == nullptr) return;
  if (!found->is_boolean()) refuse(key, fmt::format("is {}; give true or false", quote_json(*found)));
  value = found->get<bool>();
}

void JsonObject::text(std::string_view key, std::string& value) {
  const json* found = find(key);
  if (found == nullptr) return;
  if (!found->is_string()) refuse(key, fmt::format("is {}; give a text in quotes", quote_json(*found)));
  value = found->get<std::string>();
}

void JsonObject::numbers(std::string_view key, std::span<double> values, double lowest, double highest) {
  const json* found = find(key);
  if (found == nullptr) return;
  bool fits = found->is_array() && found->size() == values.size();
  for (std::size_t i = 0; fits && i < values.size(); ++i) {
    const json& element = (*found)[i];
    fits = element.is_number() && element.get<double>() >= lowest && element.get<double>() <= highest;
    if (fits) values[i] = element.get<double>();
  }
  if (!fits) {
    refuse(key, fmt::format("is {}; give a list of {} numbers from {} to {}", quote_json(*found), values.size(),
                            lowest, highest));
  }
}

std::size_t JsonObject::index_of(const json& value, std::string_view key,
                                 std::span<const std::string_view> names) const {
  const auto found = value.is_string()
                         ? std::find(names.begin(), names.end(), value.get_ref<const std::string&>())
                         : names.end();
  if (found == names.end())
    refuse(key, fmt::format("is {}; give one of {}", quote_json(value), fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

std::vector<std::size_t> JsonObject::indices_of(const json& value, std::string_view key,
                                                std::span<const std::string_view> names) const {
  if (!value.is_array() || value.empty()) {
    refuse(key, fmt::format("is {}; give a list of {}", quote_json(value), fmt::join(names, ", ")));
  }
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::size_t index = index_of(value[i], fmt::format("{}[{}]", key, i), names);
    if (std::find(indices.begin(), indices.end(), index) != indices.end()) {
      refuse(key, fmt::format("has {} twice; keep one", names[index]));
    }
    indices.push_back(index);
  }
  return indices;
}

JsonObject JsonObject::object(std::string_view key) {
  static const json kEmpty = json::object();
  const json* found = find(key);
  return JsonObject(found == nullptr ? kEmpty : *found, origin_, full(key));
}

std::vector<JsonObject> JsonObject::objects(std::string_view key, std::size_t most) {
  std::vector<JsonObject> result;
  const json* found = find(key);
  if (found == nullptr) return result;
  if (!found->is_array() || found->size() > most) {
    refuse(key, fmt::format("is {}; give a list of at most {} objects", quote_json(*found), most));
  }
  for (std::size_t i = 0; i < found->size(); ++i)
    result.emplace_back((*found)[i], origin_, fmt::format("{}[{}]", full(key), i));
  return result;
}

void JsonObject::finish() const {
  for (const auto& [key, value] : value_->items()) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      refuse(printable(key), fmt::format("is no key; the keys here are {}", fmt::join(known_, ", ")));
    }
  }
}

}  // namespace vkopple
