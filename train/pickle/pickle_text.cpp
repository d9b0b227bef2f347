#include "train/pickle/pickle_text.h"

#include <charconv>
#include <system_error>

namespace vkopple {
namespace {

constexpr std::uint32_t kLastCodePoint = 0x10FFFF;

template <class T>
std::optional<T> parsed(std::string_view text, auto... base) {
  T value{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value, base...);
  if (result.ec != std::errc{} || result.ptr != end) return std::nullopt;
  return value;
}

/// Takes exactly `digits` digits from the front of `text`.
std::optional<std::uint32_t> take_number(std::string_view& text, std::size_t digits, int base) {
  if (text.size() < digits) return std::nullopt;
  const auto value = parsed<std::uint32_t>(text.substr(0, digits), base);
  text.remove_prefix(digits);
  return value;
}

void append_utf8(std::string& out, std::uint32_t c) {
  const auto add = [&out](std::uint32_t byte) { out += static_cast<char>(static_cast<unsigned char>(byte)); };
  if (c < 0x80) {
    add(c);
  } else if (c < 0x800) {
    add(0xC0 | c >> 6);
    add(0x80 | (c & 63));
  } else if (c < 0x10000) {
    add(0xE0 | c >> 12);
    add(0x80 | (c >> 6 & 63));
    add(0x80 | (c & 63));
  } else {
    add(0xF0 | c >> 18);
    add(0x80 | (c >> 12 & 63));
    add(0x80 | (c >> 6 & 63));
    add(0x80 | (c & 63));
  }
}

bool is_octal(char c) { return c >= '0' && c <= '7'; }

/// What follows a backslash, which is taken from `text`.
std::optional<char> take_escape(std::string_view& text) {
  constexpr std::string_view kLetters = "\\'\"abfnrtv";
  constexpr std::string_view kMeanings = "\\'\"\a\b\f\n\r\t\v";
  if (text.empty()) return std::nullopt;
  if (is_octal(text[0])) {
    std::size_t digits = 1;
    while (digits < 3 && digits < text.size() && is_octal(text[digits])) ++digits;
    const auto value = take_number(text, digits, 8);
    return value && *value < 256 ? std::optional(static_cast<char>(*value)) : std::nullopt;
  }
  const char c = text[0];
  text.remove_prefix(1);
  if (c == 'x') {
    const auto value = take_number(text, 2, 16);
    return value ? std::optional(static_cast<char>(*value)) : std::nullopt;
  }
  const std::size_t found = kLetters.find(c);
  return found == std::string_view::npos ? std::nullopt : std::optional(kMeanings[found]);
}

}  // namespace

std::optional<std::string> bytes_of_literal(std::string_view literal) {
  if (literal.size() < 2 || literal.front() != literal.back()) return std::nullopt;
  const char quote = literal.front();
  if (quote != '\'' && quote != '"') return std::nullopt;
  std::string_view text = literal.substr(1, literal.size() - 2);
  std::string out;
  while (!text.empty()) {
    const char c = text[0];
    text.remove_prefix(1);
    if (c == quote) return std::nullopt;
    if (c != '\\') {
      out += c;
      continue;
    }
    const auto escaped = take_escape(text);
    if (!escaped) return std::nullopt;
    out += *escaped;
  }
  return out;
}

std::optional<std::string> utf8_of_raw_escapes(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto c = static_cast<unsigned char>(text[0]);
    const bool escape = c == '\\' && text.size() > 1 && (text[1] == 'u' || text[1] == 'U');
    if (!escape) {
      append_utf8(out, c);
      text.remove_prefix(1);
      continue;
    }
    const std::size_t digits = text[1] == 'u' ? 4 : 8;
    text.remove_prefix(2);
    const auto code = take_number(text, digits, 16);
    if (!code || *code > kLastCodePoint) return std::nullopt;
    append_utf8(out, *code);
  }
  return out;
}

std::optional<std::string> latin1_of_utf8(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < 0x80) {
      out += text[i];
      continue;
    }
    // Latin-1's upper half: C2 80 to C3 BF.
    if ((c != 0xC2 && c != 0xC3) || i + 1 == text.size()) return std::nullopt;
    const auto low = static_cast<unsigned char>(text[++i]);
    if ((low & 0xC0) != 0x80) return std::nullopt;
    out += static_cast<char>((c & 3) << 6 | (low & 63));
  }
  return out;
}

std::optional<std::int64_t> whole_number(std::string_view text) { return parsed<std::int64_t>(text, 10); }
std::optional<double> real_number(std::string_view text) { return parsed<double>(text); }

}  // namespace vkopple
