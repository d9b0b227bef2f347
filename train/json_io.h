#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace vkopple {

using Json = nlohmann::json;

/// What a text from outside may ask of us before it is refused.
struct JsonLimits {
  std::size_t max_depth = 64;           ///< nesting of objects and arrays
  std::size_t max_values = 10'000'000;  ///< keys, numbers, strings, ... in all
};

/// Parses strict JSON. `source` names the text in errors, which also give line and column. Beyond the grammar,
/// a key given twice in one object is refused (the parser would silently keep the last).
Json parse_json(std::string_view text, const std::string& source, const JsonLimits& limits = {});

/// `parse_json` of a file of at most `max_bytes`.
Json read_json(const std::filesystem::path& path, std::size_t max_bytes = std::size_t{64} << 20);

/// Writes `value`, indented by two spaces, with a final newline, through AtomicFile.
void write_json(const std::filesystem::path& path, const Json& value);

/// A value inside a JSON text together with its place there ("scene.json: objects[2].size"), so that a wrong
/// type, a missing key or a number out of range can be reported by name. It refers to the Json, which must
/// outlive it.
class JsonView {
 public:
  JsonView(const Json& value, std::string where) : value_(value), where_(std::move(where)) {}

  const Json& json() const { return value_; }
  const std::string& where() const { return where_; }

  /// Of an object.
  bool contains(const std::string& key) const;
  JsonView operator[](const std::string& key) const;

  /// Of an array.
  std::size_t size() const;
  JsonView operator[](std::size_t index) const;

  bool boolean() const;
  std::int64_t integer(std::int64_t lowest, std::int64_t highest) const;
  double number() const;  ///< always finite: JSON has no other
  const std::string& string() const;
  std::vector<double> numbers(std::size_t count) const;  ///< an array of exactly `count` numbers

  /// Throws an Error that says the value is wrong: "<where> must be <wanted>, not <value>".
  [[noreturn]] void fail(const std::string& wanted) const;

 private:
  JsonView child(std::string_view key) const;

  const Json& value_;
  std::string where_;
  bool is_root_ = true;
};

}  // namespace vkopple
