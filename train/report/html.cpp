#include "train/report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "train/image_io.h"
#include "train/report/page_style.h"

namespace vkopple {
namespace {

/// Bytes of the UTF-8 character that a text begins with; 0 where it begins with none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return 1;
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  // Longer than needed, halves of UTF-16 pairs, beyond the last character.
  static constexpr std::array<std::pair<unsigned char, std::pair<unsigned char, unsigned char>>, 4> kSecond{
      {{0xE0, {0xA0, 0xBF}}, {0xED, {0x80, 0x9F}}, {0xF0, {0x90, 0xBF}}, {0xF4, {0x80, 0x8F}}}};
  for (const auto& [first, range] : kSecond)
    if (byte(0) == first && (byte(1) < range.first || byte(1) > range.second)) return 0;
  return length;
}

std::string_view entity(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

bool is_control(char c) {
  return (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7F;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    if (const std::string_view replacement = entity(text[0]); !replacement.empty())
      out += replacement;
    else if (length == 0 || is_control(text[0]))
      out += '?';
    else
      out += text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t there = std::min<std::size_t>(bytes.size() - i, 3);
    uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (k < there ? std::to_integer<uint32_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= there ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string picture_html(const RgbImage& picture, std::string_view text) {
  return fmt::format(R"(<img src="data:image/png;base64,{}" width="{}" height="{}" alt="{}">)",
                     base64(encode_png(picture)), picture.width, picture.height, escape_html(text));
}

std::string figure_html(std::string_view html, std::string_view caption_html) {
  return fmt::format("<figure>\n{}\n<figcaption>{}</figcaption>\n</figure>\n", html, caption_html);
}

std::string section_html(std::string_view id, std::string_view heading_text, std::string_view html) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, escape_html(heading_text), html);
}

std::string page_html(std::string_view title_text, std::string_view html) {
  // Without an icon of its own a page makes a browser ask for one.
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
      escape_html(title_text), kPageStyle, html);
}

}  // namespace vkopple
