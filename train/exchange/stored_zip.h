#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace vkopple {

/// The members of a zip file by their full names, held in memory. Only stored members are read, whose bytes lie
/// in the file as they are, so that all together are no larger than the file; one that is compressed is
/// refused. Throws Error that names the file, and the member where there is one.
std::map<std::string, std::vector<std::byte>> read_stored_zip(const std::filesystem::path& path);

/// Whether a file starts as a zip does. Throws Error where it can't be read.
bool is_zip(const std::filesystem::path& path);

}  // namespace vkopple
