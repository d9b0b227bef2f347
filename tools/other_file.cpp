#include "tools/other_file.h"

#include <fmt/format.h>

#include <system_error>

#include "runtime/error.h"

namespace vkopple {

void require_other_file(const std::filesystem::path& written, const std::filesystem::path& read) {
  std::error_code absent;
  if (std::filesystem::equivalent(written, read, absent))
    throw UsageError(fmt::format("{}: is the file that is read, {}; name another to write", written.string(),
                                 read.string()));
}

}  // namespace vkopple
