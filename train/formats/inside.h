#pragma once

#include <filesystem>
#include <string>

namespace vkopple {

/// `folder / name`, of a name that a file gave. Throws Error, which begins with `where`, where the name is
/// empty, absolute, or climbs out of the folder.
std::filesystem::path inside(const std::filesystem::path& folder, const std::string& name,
                             const std::string& where);

}  // namespace vkopple
