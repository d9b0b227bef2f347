#include "train/pickle/pickle_machine.h"

#include <fmt/format.h>

#include <bit>
#include <optional>
#include <utility>

#include "train/pickle/pickle_builtins.h"
#include "train/pickle/pickle_text.h"
#include "train/quote.h"

namespace vkopple {
namespace {

/// Of Python's pickletools, with their names there.
enum Opcode : std::uint8_t {
  kMark = '(',
  kStop = '.',
  kPop = '0',
  kPopMark = '1',
  kDup = '2',
  kFloat = 'F',
  kInt = 'I',
  kBinInt = 'J',
  kBinInt1 = 'K',
  kLong = 'L',
  kBinInt2 = 'M',
  kNone = 'N',
  kBinPersId = 'Q',
  kReduce = 'R',
  kString = 'S',
  kBinString = 'T',
  kShortBinString = 'U',
  kUnicode = 'V',
  kBinUnicode = 'X',
  kAppend = 'a',
  kBuild = 'b',
  kGlobal = 'c',
  kDict = 'd',
  kEmptyDict = '}',
  kAppends = 'e',
  kGet = 'g',
  kBinGet = 'h',
  kLongBinGet = 'j',
  kList = 'l',
  kEmptyList = ']',
  kPut = 'p',
  kBinPut = 'q',
  kLongBinPut = 'r',
  kSetItem = 's',
  kTuple = 't',
  kEmptyTuple = ')',
  kSetItems = 'u',
  kBinFloat = 'G',
  kBinBytes = 'B',
  kShortBinBytes = 'C',
  kProto = 0x80,
  kNewObj = 0x81,
  kTuple1 = 0x85,
  kTuple2 = 0x86,
  kTuple3 = 0x87,
  kNewTrue = 0x88,
  kNewFalse = 0x89,
  kLong1 = 0x8A,
  kLong4 = 0x8B,
  kShortBinUnicode = 0x8C,
  kBinUnicode8 = 0x8D,
  kBinBytes8 = 0x8E,
  kEmptySet = 0x8F,
  kAddItems = 0x90,
  kFrozenSet = 0x91,
  kStackGlobal = 0x93,
  kMemoize = 0x94,
  kFrame = 0x95,
  kByteArray8 = 0x96,
};

constexpr std::uint64_t kNewestProtocol = 5;

std::int64_t sign_extended(std::uint64_t value, std::size_t bytes) {
  const std::size_t unused = 64 - 8 * bytes;
  return std::bit_cast<std::int64_t>(value << unused) >> unused;
}

}  // namespace

PickleValue PickleMachine::run() {
  for (;;) {
    const std::uint8_t op = input_.opcode();
    if (op == kStop) break;
    const bool done =
        number(op) || text(op) || container(op) || addition(op) || memory(op) || stack(op) || object(op);
    if (!done) refuse(op);
  }
  if (stack_.size() != 1 || !marks_.empty())
    input_.fail(fmt::format("it leaves {} values instead of one; it is damaged", stack_.size()));
  if (input_.left() > 0) input_.fail(fmt::format("{} bytes follow its end; it is damaged", input_.left()));
  return stack_.back();
}

void PickleMachine::refuse(std::uint8_t op) const {
  const bool printable = op > 32 && op < 127;
  input_.fail(
      fmt::format("the instruction 0x{:02x}{} is not one of plain data; it is damaged, or holds more than "
                  "containers, numbers and strings",
                  op, printable ? fmt::format(" ('{}')", static_cast<char>(op)) : std::string()));
}

bool PickleMachine::number(std::uint8_t op) {
  switch (op) {
    case kNone:
      push(PickleValue());
      return true;
    case kNewTrue:
    case kNewFalse:
      push(PickleValue(op == kNewTrue));
      return true;
    case kInt:
    case kLong:
      push_whole(input_.line());
      return true;
    case kBinInt:
      push(PickleValue(sign_extended(input_.little(4), 4)));
      return true;
    case kBinInt1:
      push(PickleValue(static_cast<std::int64_t>(input_.little(1))));
      return true;
    case kBinInt2:
      push(PickleValue(static_cast<std::int64_t>(input_.little(2))));
      return true;
    case kLong1:
      push_long(input_.counted(1));
      return true;
    case kLong4:
      push_long(input_.counted(4));
      return true;
    case kFloat: {
      const std::string_view digits = input_.line();
      push(PickleValue(parsed(real_number(digits), digits, "a number")));
      return true;
    }
    case kBinFloat:
      push(PickleValue(input_.big_double()));
      return true;
    default:
      return false;
  }
}

template <class T>
T PickleMachine::parsed(std::optional<T> value, std::string_view text, const char* what) const {
  if (!value) input_.fail(fmt::format("{} is not {}", quote(text), what));
  return std::move(*value);
}

/// Protocol 0 writes True as 01, False as 00, and an L behind what Python 2 called a long.
void PickleMachine::push_whole(std::string_view digits) {
  if (digits == "01" || digits == "00") {
    push(PickleValue(digits == "01"));
    return;
  }
  const std::string_view number = digits.substr(0, digits.size() - (digits.ends_with('L') ? 1 : 0));
  push(PickleValue(parsed(whole_number(number), digits, "a whole number of 64 bits")));
}

void PickleMachine::push_long(std::string_view bytes) {
  if (bytes.size() > sizeof(std::int64_t))
    input_.fail(fmt::format("a whole number of {} bytes; at most 8 are read", bytes.size()));
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | static_cast<std::uint8_t>(bytes[i]);
  push(PickleValue(bytes.empty() ? std::int64_t{0} : sign_extended(value, bytes.size())));
}

bool PickleMachine::text(std::uint8_t op) {
  const auto read = [&](PickleKind kind, std::size_t length_bytes) {
    push_text(kind, input_.counted(length_bytes));
    return true;
  };
  switch (op) {
    case kString: {
      const std::string_view literal = input_.line();
      push_text(PickleKind::kString, parsed(bytes_of_literal(literal), literal, "a string of Python"));
      return true;
    }
    case kUnicode: {
      const std::string_view line = input_.line();
      push_text(PickleKind::kString, parsed(utf8_of_raw_escapes(line), line, "a string of Python"));
      return true;
    }
    case kShortBinString:
    case kShortBinUnicode:
      return read(PickleKind::kString, 1);
    case kBinString:
    case kBinUnicode:
      return read(PickleKind::kString, 4);
    case kBinUnicode8:
      return read(PickleKind::kString, 8);
    case kShortBinBytes:
      return read(PickleKind::kBytes, 1);
    case kBinBytes:
      return read(PickleKind::kBytes, 4);
    case kBinBytes8:
    case kByteArray8:
      return read(PickleKind::kBytes, 8);
    default:
      return false;
  }
}

bool PickleMachine::container(std::uint8_t op) {
  const auto made = [&](PickleKind kind, std::vector<PickleValue> items) {
    push_node(kind, std::move(items));
    return true;
  };
  switch (op) {
    case kEmptyTuple:
      return made(PickleKind::kTuple, {});
    case kTuple1:
    case kTuple2:
    case kTuple3:
      return made(PickleKind::kTuple, pop_count(op - kTuple1 + std::size_t{1}));
    case kTuple:
      return made(PickleKind::kTuple, pop_mark());
    case kEmptyList:
      return made(PickleKind::kList, {});
    case kList:
      return made(PickleKind::kList, pop_mark());
    case kEmptySet:
      return made(PickleKind::kSet, {});
    case kFrozenSet:
      return made(PickleKind::kSet, pop_mark());
    case kEmptyDict:
      return made(PickleKind::kDict, {});
    case kDict: {
      std::vector<PickleValue> items = pop_mark();
      push_node(PickleKind::kDict, {});
      add_entries(std::move(items));
      return true;
    }
    default:
      return false;
  }
}

bool PickleMachine::addition(std::uint8_t op) {
  switch (op) {
    case kAppend:
      add_to(PickleKind::kList, pop_count(1));
      return true;
    case kAppends:
      add_to(PickleKind::kList, pop_mark());
      return true;
    case kAddItems:
      add_to(PickleKind::kSet, pop_mark());
      return true;
    case kSetItem:
      add_entries(pop_count(2));
      return true;
    case kSetItems:
      add_entries(pop_mark());
      return true;
    default:
      return false;
  }
}

void PickleMachine::add_to(PickleKind kind, std::vector<PickleValue> items) {
  if (!top().is(kind))
    input_.fail(
        fmt::format("it adds items to {} instead of {}; it is damaged", name_of(top().kind()), name_of(kind)));
  auto& into = PickleArena::node_of(top())->items;
  into.insert(into.end(), items.begin(), items.end());
}

void PickleMachine::add_entries(std::vector<PickleValue> items) {
  if (items.size() % 2 != 0) input_.fail("a dict with a key that has no value; it is damaged");
  add_to(PickleKind::kDict, std::move(items));
}

bool PickleMachine::stack(std::uint8_t op) {
  switch (op) {
    case kProto: {
      const std::uint64_t version = input_.little(1);
      if (version > kNewestProtocol)
        input_.fail(fmt::format("protocol {}; this program reads those up to {}", version, kNewestProtocol));
      return true;
    }
    case kFrame:  // only says how much may be read ahead
      input_.little(8);
      return true;
    case kMark:
      marks_.push_back(stack_.size());
      return true;
    case kPop:
      if (!marks_.empty() && marks_.back() == stack_.size())
        marks_.pop_back();
      else
        pop();
      return true;
    case kPopMark:
      pop_mark();
      return true;
    case kDup:
      push(top());
      return true;
    default:
      return false;
  }
}

bool PickleMachine::memory(std::uint8_t op) {
  switch (op) {
    case kPut:
      remember(index_of(input_.line()));
      return true;
    case kBinPut:
      remember(input_.little(1));
      return true;
    case kLongBinPut:
      remember(input_.little(4));
      return true;
    case kMemoize:
      remember(memo_.size());
      return true;
    case kGet:
      recall(index_of(input_.line()));
      return true;
    case kBinGet:
      recall(input_.little(1));
      return true;
    case kLongBinGet:
      recall(input_.little(4));
      return true;
    default:
      return false;
  }
}

std::uint64_t PickleMachine::index_of(std::string_view digits) const {
  const std::int64_t index = parsed(whole_number(digits), digits, "a whole number");
  if (index < 0) input_.fail(fmt::format("{} is not a place to remember at", index));
  return static_cast<std::uint64_t>(index);
}

void PickleMachine::remember(std::uint64_t index) { memo_[index] = top(); }

void PickleMachine::recall(std::uint64_t index) {
  const auto found = memo_.find(index);
  if (found == memo_.end())
    input_.fail(fmt::format("it recalls value {}, which it never gave; it is damaged", index));
  push(found->second);
}

bool PickleMachine::object(std::uint8_t op) {
  switch (op) {
    case kGlobal: {
      const std::string_view module = input_.line();
      push_global(module, input_.line());
      return true;
    }
    case kStackGlobal: {
      const PickleValue name = pop(PickleKind::kString);
      const PickleValue module = pop(PickleKind::kString);
      push_global(module.text(), name.text());
      return true;
    }
    case kBinPersId:
      push_node(PickleKind::kPersistent, pop_count(1));
      return true;
    case kReduce:
    case kNewObj:
      call();
      return true;
    case kBuild:
      build();
      return true;
    default:
      return false;
  }
}

void PickleMachine::push_global(std::string_view module, std::string_view name) {
  const std::string full = fmt::format("{}.{}", module, name);
  if (!is_builtin_global(full) && !allowed_.contains(full)) {
    const bool pandas = full.starts_with("pandas.");
    input_.fail(fmt::format("refers to {}, which is refused: {}", quote(full),
                            pandas
                                ? "save the table as a dict of lists: pickle.dump(table.to_dict('list'), file)"
                                : "nothing but plain data is read from a pickle"));
  }
  push_text(PickleKind::kGlobal, full);
}

void PickleMachine::call() {
  const PickleValue arguments = pop(PickleKind::kTuple);
  const PickleValue global = pop(PickleKind::kGlobal);
  if (!is_builtin_global(global.text())) {
    push_node(PickleKind::kCall, {global, arguments});
    return;
  }
  const auto value = call_builtin(arena_, global.text(), arguments.items());
  if (!value) input_.fail(fmt::format("{} with arguments that are not understood", quote(global.text())));
  // It is a copy of its argument, which one instruction of a few bytes may ask for again and again.
  charge(value->is(PickleKind::kBytes) ? value->text().size() / sizeof(PickleValue) : value->items().size());
  push(*value);
}

void PickleMachine::build() {
  const PickleValue state = pop();
  PickleNode* node = PickleArena::node_of(top());
  if (node == nullptr) input_.fail(fmt::format("it gives a state to {}; it is damaged", name_of(top().kind())));
  node->state = state;
}

void PickleMachine::charge(std::size_t count) {
  if (values_left_ < count) input_.fail("more values than are allowed; split the file, or is it damaged?");
  values_left_ -= count;
}

void PickleMachine::push(PickleValue value) {
  charge(1);
  stack_.push_back(value);
}

void PickleMachine::push_text(PickleKind kind, std::string_view text) {
  push(arena_.text(kind, std::string(text)));
}

void PickleMachine::push_node(PickleKind kind, std::vector<PickleValue> items) {
  push(arena_.node(kind, std::move(items)));
}

PickleValue& PickleMachine::top() {
  const std::size_t floor = marks_.empty() ? 0 : marks_.back();
  if (stack_.size() <= floor) input_.fail("it takes a value that it has not given; it is damaged");
  return stack_.back();
}

PickleValue PickleMachine::pop() {
  const PickleValue value = top();
  stack_.pop_back();
  return value;
}

PickleValue PickleMachine::pop(PickleKind kind) {
  const PickleValue value = pop();
  if (!value.is(kind))
    input_.fail(fmt::format("{} where {} was expected; it is damaged", name_of(value.kind()), name_of(kind)));
  return value;
}

std::vector<PickleValue> PickleMachine::pop_mark() {
  if (marks_.empty()) input_.fail("it ends a group that it has not begun; it is damaged");
  const auto begin = stack_.begin() + static_cast<std::ptrdiff_t>(marks_.back());
  std::vector<PickleValue> items(begin, stack_.end());
  stack_.erase(begin, stack_.end());
  marks_.pop_back();
  return items;
}

std::vector<PickleValue> PickleMachine::pop_count(std::size_t count) {
  std::vector<PickleValue> items(count);
  for (std::size_t i = count; i-- > 0;) items[i] = pop();
  return items;
}

}  // namespace vkopple
