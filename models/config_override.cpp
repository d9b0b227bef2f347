#include "models/config_override.h"

#include <fmt/format.h>

#include <charconv>
#include <string>

#include "models/quote_json.h"
#include "models/strict_json.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

using nlohmann::json;

constexpr std::string_view kKeyCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
constexpr std::size_t kLongestShown = 200;
constexpr std::size_t kDeepest = 32;  // far beyond any configuration

/// Walks the keys of one assignment.
class Path {
 public:
  explicit Path(std::string_view text) : text_(text), rest_(text) {}

  json& follow(json& root) {
    json* place = &member(root);
    for (std::size_t level = 1; !rest_.empty(); ++level) {
      if (level == kDeepest) refuse("asks for a key that is nested too deep; no key is");
      const bool index = rest_.front() == '[';
      if (!index && rest_.front() != '.') refuse("is no key; write it as training.stages[0].steps");
      rest_.remove_prefix(1);
      place = index ? &element(*place) : &member(*place);
    }
    return *place;
  }

 private:
  std::string_view done() const { return text_.substr(0, text_.size() - rest_.size()); }

  [[noreturn]] void refuse(std::string_view problem) const {
    throw UsageError(fmt::format("--set {} {}", printable(text_, kLongestShown), problem));
  }

  json& member(json& object) {
    const std::string before(done());
    const std::string_view key = rest_.substr(0, rest_.find_first_not_of(kKeyCharacters));
    if (key.empty()) refuse("is no key; write it as training.stages[0].steps");
    if (!object.is_object() && !object.is_null())
      refuse(fmt::format("asks for a part of {}, which has none", before));
    rest_.remove_prefix(key.size());
    return object[std::string(key)];
  }

  json& element(json& list) {
    std::size_t index = 0;
    const auto [end, failure] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), index);
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    if (failure != std::errc() || !rest_.starts_with(']'))
      refuse("is no key; write it as training.stages[0].steps");
    if (!list.is_array() || index >= list.size())
      refuse(fmt::format("asks for an element that the configuration does not have; its list has {}",
                         list.is_array() ? list.size() : 0));
    rest_.remove_prefix(1);
    return list[index];
  }

  std::string_view text_;
  std::string_view rest_;
};

}  // namespace

void override_value(json& root, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == assignment.npos)
    throw UsageError(
        fmt::format("--set {}: give KEY=VALUE, as model.reg=0.5", printable(assignment, kLongestShown)));
  const std::string_view key = assignment.substr(0, equals);
  const std::string_view value = assignment.substr(equals + 1);
  json& place = Path(key).follow(root);
  place = json::accept(value) ? parse_strict_json(value, fmt::format("--set {}", key)) : json(value);
}

}  // namespace vkopple
