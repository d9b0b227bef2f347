#include "train/pickle/pickle_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr std::array<std::string_view, 13> kNames{
    "None",   "a truth value", "a whole number", "a number", "a string", "bytes",          "a tuple",
    "a list", "a dict",        "a set",          "a global", "a call",   "a persistent id"};

bool has_text(PickleKind kind) {
  return kind == PickleKind::kString || kind == PickleKind::kBytes || kind == PickleKind::kGlobal;
}

bool has_items(PickleKind kind) {
  switch (kind) {
    case PickleKind::kTuple:
    case PickleKind::kList:
    case PickleKind::kDict:
    case PickleKind::kSet:
    case PickleKind::kCall:
    case PickleKind::kPersistent:
      return true;
    default:
      return false;
  }
}

/// `room` levels are left for the value. Heights are kept, so that what is shared is walked once.
bool fits(const PickleValue& value, std::size_t room) {
  PickleNode* node = PickleArena::node_of(value);
  if (node == nullptr) return true;
  if (node->height > 0) return node->height <= room;
  if (room == 0) return false;
  std::size_t below = 0;
  const auto visit = [&](const PickleValue& child) {
    if (!fits(child, room - 1)) return false;
    const PickleNode* inner = PickleArena::node_of(child);
    below = std::max(below, inner == nullptr ? 0 : inner->height);
    return true;
  };
  if (!std::all_of(node->items.begin(), node->items.end(), visit) || !visit(node->state)) return false;
  node->height = below + 1;
  return true;
}

}  // namespace

std::string_view name_of(PickleKind kind) { return kNames.at(static_cast<std::size_t>(kind)); }

void PickleValue::expect(PickleKind kind) const {
  if (kind_ != kind) throw Error(fmt::format("{} was expected, not {}", name_of(kind), name_of(kind_)));
}

bool PickleValue::boolean() const {
  expect(PickleKind::kBool);
  return bool_;
}

std::int64_t PickleValue::integer() const {
  expect(PickleKind::kInt);
  return int_;
}

double PickleValue::real() const {
  expect(PickleKind::kFloat);
  return float_;
}

const std::string& PickleValue::text() const {
  if (!has_text(kind_)) expect(PickleKind::kString);
  return *text_;
}

std::span<const PickleValue> PickleValue::items() const {
  if (!has_items(kind_)) expect(PickleKind::kList);
  return node_->items;
}

const PickleValue* PickleValue::find(std::string_view key) const {
  expect(PickleKind::kDict);
  const auto& items = node_->items;
  for (std::size_t i = items.size(); i >= 2; i -= 2) {
    const PickleValue& candidate = items[i - 2];
    if (candidate.is(PickleKind::kString) && candidate.text() == key) return &items[i - 1];
  }
  return nullptr;
}

PickleValue PickleValue::state() const {
  if (!has_items(kind_)) expect(PickleKind::kCall);
  return node_->state;
}

bool PickleValue::is_call(std::string_view global) const {
  return kind_ == PickleKind::kCall && node_->items[0].text() == global;
}

std::span<const PickleValue> PickleValue::arguments() const {
  expect(PickleKind::kCall);
  return node_->items[1].items();
}

PickleValue PickleArena::text(PickleKind kind, std::string text) {
  PickleValue value;
  value.kind_ = kind;
  value.text_ = &texts_.emplace_back(std::move(text));
  return value;
}

PickleValue PickleArena::node(PickleKind kind, std::vector<PickleValue> items) {
  PickleValue value;
  value.kind_ = kind;
  value.node_ = &nodes_.emplace_back();
  value.node_->items = std::move(items);
  return value;
}

PickleNode* PickleArena::node_of(const PickleValue& value) {
  return has_items(value.kind_) ? value.node_ : nullptr;
}

bool within_depth(const PickleValue& value, std::size_t most) { return fits(value, most); }

}  // namespace vkopple
