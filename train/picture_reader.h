#pragma once

#include <cstddef>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace vkopple {

/// The most that picture_reader() looks at.
constexpr std::size_t kPictureStart = 16;

/// Which of OpenImageIO's readers is for a file with these first bytes and this ending of its name ("jpg"), ""
/// for what is no picture or video of a known kind. Left to itself the library goes by the ending, and where
/// that is "mp4" or "avi" its FFmpeg follows a text that lists files to these.
std::string_view picture_reader(std::span<const std::byte> start, std::string_view ending);

/// Names of all that picture_reader() can return.
const std::set<std::string_view>& picture_readers();

/// The ending of a file's name in small letters, without the dot: "a.JPG" has "jpg".
std::string small_ending(const std::string& name);

}  // namespace vkopple
