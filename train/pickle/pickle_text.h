#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace vkopple {

// How Python writes strings in the old protocols. Each is nothing where the text is malformed.

/// A Python literal of bytes in single or double quotes, with its escapes: '\x00a'.
std::optional<std::string> bytes_of_literal(std::string_view literal);

/// "Raw unicode escape" to UTF-8: Latin-1 with \uXXXX and \UXXXXXXXX.
std::optional<std::string> utf8_of_raw_escapes(std::string_view text);

/// UTF-8 to the bytes of Latin-1.
std::optional<std::string> latin1_of_utf8(std::string_view text);

/// Decimal, with a sign at most before it.
std::optional<std::int64_t> whole_number(std::string_view text);
std::optional<double> real_number(std::string_view text);

}  // namespace vkopple
