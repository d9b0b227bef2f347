#pragma once

#include <filesystem>

namespace vkopple {

/// Refuses to write to the file that is read, be it by another path or a link; a file that is not there is
/// another. Throws UsageError.
void require_other_file(const std::filesystem::path& written, const std::filesystem::path& read);

}  // namespace vkopple
