#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vkopple {

/// Parses a JSON text from outside. `origin` (a file name, say) opens every message.
/// Throws Error for a syntax error, a key that appears twice in one object, and nesting deeper than 32.
nlohmann::json parse_strict_json(std::string_view text, std::string_view origin);

/// Reads the members of one JSON object and refuses what nobody asked for.
///
/// Each getter leaves `value` as it was where the key is absent, and throws Error naming the full key
/// ("training.clip.depth") and the allowed range where the value has the wrong type or lies outside. Call
/// finish() last: it refuses the keys never read.
class JsonObject {
 public:
  /// `path` is the object's full key, empty for the document's root. `value` must outlive this object.
  JsonObject(const nlohmann::json& value, std::string origin, std::string path);

  void integer(std::string_view key, int& value, int lowest, int highest);
  void integer(std::string_view key, std::int64_t& value, std::int64_t lowest, std::int64_t highest);
  void number(std::string_view key, double& value, double lowest, double highest);
  void boolean(std::string_view key, bool& value);
  void text(std::string_view key, std::string& value);
  /// As many numbers as `values` has.
  void numbers(std::string_view key, std::span<double> values, double lowest, double highest);
  /// One of `names`; E's values index them.
  template <class E, std::size_t N>
  void choice(std::string_view key, E& value, const std::array<std::string_view, N>& names) {
    if (const nlohmann::json* found = find(key)) value = static_cast<E>(index_of(*found, key, names));
  }
  /// A list of different names out of `names`, at least one.
  template <class E, std::size_t N>
  void choices(std::string_view key, std::vector<E>& values, const std::array<std::string_view, N>& names) {
    if (const nlohmann::json* found = find(key)) {
      values.clear();
      for (const std::size_t index : indices_of(*found, key, names)) values.push_back(static_cast<E>(index));
    }
  }

  bool has(std::string_view key) const { return value_->contains(key); }
  /// The member as an object; one without members where the key is absent.
  JsonObject object(std::string_view key);
  /// The member's elements as objects; none where the key is absent.
  std::vector<JsonObject> objects(std::string_view key, std::size_t most);

  void finish() const;

  /// Throws Error: "ORIGIN: KEY problem".
  [[noreturn]] void refuse(std::string_view key, std::string_view problem) const;

 private:
  const nlohmann::json* find(std::string_view key);
  std::string full(std::string_view key) const;
  std::size_t index_of(const nlohmann::json& value, std::string_view key,
                       std::span<const std::string_view> names) const;
  std::vector<std::size_t> indices_of(const nlohmann::json& value, std::string_view key,
                                      std::span<const std::string_view> names) const;

  const nlohmann::json* value_;
  std::string origin_;
  std::string path_;
  std::vector<std::string> known_;
};

}  // namespace vkopple
