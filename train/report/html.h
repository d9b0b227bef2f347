#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "train/image.h"

namespace vkopple {

// Pieces of a page in HTML. What is called `text` is escaped, what is called `html` is taken as it is.

/// Text as it may stand between tags and in quoted attributes. Control characters but line ends and tabs become
/// '?', and so do bytes that are not UTF-8.
std::string escape_html(std::string_view text);

/// With padding, as data: URIs take it.
std::string base64(std::span<const std::byte> bytes);

/// The picture as a PNG inside an <img>. `text`: what it shows, for those who don't see it.
std::string picture_html(const RgbImage& picture, std::string_view text);

/// Something to look at above what is said of it.
std::string figure_html(std::string_view html, std::string_view caption_html);

/// A part of the page with its heading.
std::string section_html(std::string_view id, std::string_view heading_text, std::string_view html);

/// A whole page with the report's style, which asks nothing of a network.
std::string page_html(std::string_view title_text, std::string_view html);

}  // namespace vkopple
