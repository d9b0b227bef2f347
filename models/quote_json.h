#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace vkopple {

/// A value as a message shows it: on one line, printable, cut off behind `longest` bytes.
std::string quote_json(const nlohmann::json& value, std::size_t longest = 40);
/// The same of a text, without the quotation marks.
std::string printable(std::string_view text, std::size_t longest = 40);

}  // namespace vkopple
