#include "train/pickle/pickle_builtins.h"

#include <algorithm>
#include <array>

#include "train/pickle/pickle_text.h"

namespace vkopple {
namespace {

using Arguments = std::span<const PickleValue>;
using Call = std::optional<PickleValue> (*)(PickleArena&, Arguments);

bool is_sequence(const PickleValue& value) {
  return value.is(PickleKind::kList) || value.is(PickleKind::kTuple);
}

/// OrderedDict() or OrderedDict([[key, value], ...]).
std::optional<PickleValue> ordered_dict(PickleArena& arena, Arguments arguments) {
  std::vector<PickleValue> items;
  if (arguments.size() > 1 || (arguments.size() == 1 && !is_sequence(arguments[0]))) return std::nullopt;
  for (const PickleValue& pair : arguments.empty() ? Arguments{} : arguments[0].items()) {
    if (!is_sequence(pair) || pair.items().size() != 2) return std::nullopt;
    items.insert(items.end(), pair.items().begin(), pair.items().end());
  }
  return arena.node(PickleKind::kDict, std::move(items));
}

std::optional<PickleValue> set(PickleArena& arena, Arguments arguments) {
  if (arguments.empty()) return arena.node(PickleKind::kSet, {});
  if (arguments.size() != 1 || !is_sequence(arguments[0])) return std::nullopt;
  return arena.node(PickleKind::kSet, {arguments[0].items().begin(), arguments[0].items().end()});
}

/// encode("text", "latin1"), bytearray("text", "latin-1").
std::optional<PickleValue> encode(PickleArena& arena, Arguments arguments) {
  const auto is_string = [](const PickleValue& value) { return value.is(PickleKind::kString); };
  if (arguments.size() != 2 || !std::all_of(arguments.begin(), arguments.end(), is_string)) return std::nullopt;
  if (arguments[1].text() != "latin1" && arguments[1].text() != "latin-1") return std::nullopt;
  auto bytes = latin1_of_utf8(arguments[0].text());
  return bytes ? std::optional(arena.text(PickleKind::kBytes, std::move(*bytes))) : std::nullopt;
}

/// bytes(), bytes(b"..."), bytearray(b"...").
std::optional<PickleValue> bytes(PickleArena& arena, Arguments arguments) {
  if (arguments.empty()) return arena.text(PickleKind::kBytes, {});
  if (arguments.size() == 1 && arguments[0].is(PickleKind::kBytes)) return arguments[0];
  return encode(arena, arguments);
}

struct Builtin {
  std::string_view name;
  Call call;
};
constexpr std::array<Builtin, 10> kBuiltins{{{"collections.OrderedDict", ordered_dict},
                                             {"builtins.set", set},
                                             {"builtins.frozenset", set},
                                             {"builtins.bytes", bytes},
                                             {"builtins.bytearray", bytes},
                                             {"__builtin__.set", set},
                                             {"__builtin__.frozenset", set},
                                             {"__builtin__.bytes", bytes},
                                             {"__builtin__.bytearray", bytes},
                                             {"_codecs.encode", encode}}};

const Builtin* find(std::string_view name) {
  const auto* found =
      std::find_if(kBuiltins.begin(), kBuiltins.end(), [&](const Builtin& b) { return b.name == name; });
  return found == kBuiltins.end() ? nullptr : found;
}

}  // namespace

bool is_builtin_global(std::string_view name) { return find(name) != nullptr; }

std::optional<PickleValue> call_builtin(PickleArena& arena, std::string_view name, Arguments arguments) {
  return find(name)->call(arena, arguments);
}

}  // namespace vkopple
