#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "train/pickle/pickle_input.h"
#include "train/pickle/pickle_value.h"

namespace vkopple {

/// Runs the instructions of a pickle on a stack of values; builds plain data and calls nothing.
class PickleMachine {
 public:
  PickleMachine(PickleInput& input, PickleArena& arena, const std::set<std::string>& allowed,
                std::size_t max_values)
      : input_(input), arena_(arena), allowed_(allowed), values_left_(max_values) {}

  /// What the pickle leaves; throws Error with the place of whatever it can't or may not do.
  PickleValue run();

 private:
  // Each takes the instructions of one kind and says whether `op` was one.
  bool number(std::uint8_t op);
  bool text(std::uint8_t op);
  bool container(std::uint8_t op);
  bool addition(std::uint8_t op);
  bool stack(std::uint8_t op);
  bool memory(std::uint8_t op);
  bool object(std::uint8_t op);
  [[noreturn]] void refuse(std::uint8_t op) const;

  void charge(std::size_t count);  ///< refuses more values than are allowed in all
  void push(PickleValue value);
  void push_text(PickleKind kind, std::string_view text);
  void push_node(PickleKind kind, std::vector<PickleValue> items);
  PickleValue pop();
  PickleValue pop(PickleKind kind);
  PickleValue& top();
  std::vector<PickleValue> pop_mark();  ///< what was pushed since the last mark, which goes too
  std::vector<PickleValue> pop_count(std::size_t count);

  void push_whole(std::string_view digits);
  void push_long(std::string_view bytes);
  template <class T>
  T parsed(std::optional<T> value, std::string_view text, const char* what) const;
  void add_to(PickleKind kind, std::vector<PickleValue> items);
  void add_entries(std::vector<PickleValue> items);
  void remember(std::uint64_t index);
  void recall(std::uint64_t index);
  std::uint64_t index_of(std::string_view digits) const;
  void push_global(std::string_view module, std::string_view name);
  void call();
  void build();

  PickleInput& input_;
  PickleArena& arena_;
  const std::set<std::string>& allowed_;
  std::size_t values_left_;
  std::vector<PickleValue> stack_;
  std::vector<std::size_t> marks_;  ///< sizes of the stack
  std::unordered_map<std::uint64_t, PickleValue> memo_;
};

}  // namespace vkopple
