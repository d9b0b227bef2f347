#pragma once

#include <string>
#include <string_view>

namespace vkopple {

/// Text from outside as it may stand in a one-line message: control characters become '?', and what goes on
/// past `longest` bytes is cut off with "...".
std::string one_line(std::string_view text, std::size_t longest = 200);

/// The same between single quotes, for names.
std::string quote(std::string_view text, std::size_t longest = 120);

}  // namespace vkopple
