#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "train/pickle/pickle_value.h"

namespace vkopple {

/// Whether a global is one of the containers and conversions of Python's own that stand for plain data:
/// OrderedDict, set, frozenset, bytes, bytearray, and the encode by which old protocols write bytes.
bool is_builtin_global(std::string_view name);

/// The plain value that calling one gives; nothing where the arguments are not those that pickles have.
std::optional<PickleValue> call_builtin(PickleArena& arena, std::string_view name,
                                        std::span<const PickleValue> arguments);

}  // namespace vkopple
