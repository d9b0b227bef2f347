#pragma once

#include <filesystem>
#include <vector>

namespace vkopple {

/// The files that a path names: itself, or what a folder holds (but not folders within) under names that files
/// of pictures and films have, in the natural order of names. Hidden files are left out. Throws Error where a
/// folder can't be read or holds none.
std::vector<std::filesystem::path> image_files(const std::filesystem::path& path);

}  // namespace vkopple
