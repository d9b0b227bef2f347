#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vkopple {

enum class PickleKind : std::uint8_t {
  kNone,
  kBool,
  kInt,
  kFloat,
  kString,
  kBytes,
  kTuple,
  kList,
  kDict,
  kSet,         ///< frozen or not
  kGlobal,      ///< a function or class that the caller allowed, by its name
  kCall,        ///< of such a global; nothing was called
  kPersistent,  ///< what the pickle names but keeps elsewhere
};

/// "a list", as messages say it.
std::string_view name_of(PickleKind kind);

struct PickleNode;

/// One value of a pickle: plain data, or a description of what Python would call. Small, and valid as long as
/// the Pickle that it is of. An accessor of another kind throws Error.
class PickleValue {
 public:
  PickleValue() = default;  ///< None
  explicit PickleValue(bool value) : kind_(PickleKind::kBool), bool_(value) {}
  explicit PickleValue(std::int64_t value) : kind_(PickleKind::kInt), int_(value) {}
  explicit PickleValue(double value) : kind_(PickleKind::kFloat), float_(value) {}

  PickleKind kind() const { return kind_; }
  bool is(PickleKind kind) const { return kind_ == kind; }

  bool boolean() const;
  std::int64_t integer() const;
  double real() const;
  /// Of a string (UTF-8, but for byte strings of Python 2), of bytes, or "module.name" of a global.
  const std::string& text() const;
  /// Of a tuple, list or set, in the order of the pickle; a set's may repeat. Of a call: the global and the
  /// tuple of arguments. Of a persistent: its id. Of a dict: key, value, key, value.
  std::span<const PickleValue> items() const;
  /// Of a dict; null where there is no such key. Of a key given twice the last counts, as in Python.
  const PickleValue* find(std::string_view key) const;
  /// What BUILD handed to a dict, list, set or call; None where nothing was.
  PickleValue state() const;

  /// Whether this is a call of that global.
  bool is_call(std::string_view global) const;
  /// Of a call.
  std::span<const PickleValue> arguments() const;

 private:
  friend class PickleArena;
  void expect(PickleKind kind) const;

  PickleKind kind_ = PickleKind::kNone;
  union {
    bool bool_;
    std::int64_t int_ = 0;
    double float_;
    const std::string* text_;
    PickleNode* node_;
  };
};

struct PickleNode {
  std::vector<PickleValue> items;
  PickleValue state;
  std::size_t height = 0;  ///< levels of nesting below and with this one; 0: not measured yet
};

/// Owns what the values of one pickle refer to. References may be shared and, until within_depth has
/// looked, circular.
class PickleArena {
 public:
  PickleValue text(PickleKind kind, std::string text);
  PickleValue node(PickleKind kind, std::vector<PickleValue> items);
  /// Null where the value has no items of its own.
  static PickleNode* node_of(const PickleValue& value);

 private:
  std::deque<std::string> texts_;
  std::deque<PickleNode> nodes_;
};

/// Whether nothing in the value is nested deeper than `most` levels; what contains itself is.
bool within_depth(const PickleValue& value, std::size_t most);

}  // namespace vkopple
