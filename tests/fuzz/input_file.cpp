#include "tests/fuzz/input_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <string>

namespace vkopple::fuzz {

InputFile::InputFile(Input content)
    : file_(::memfd_create("input", MFD_CLOEXEC)), path_("/proc/self/fd/" + std::to_string(file_.get())) {
  require(file_.is_open(), "a file in memory can be made");
  while (!content.empty()) {
    const ssize_t written = ::write(file_.get(), content.data(), content.size());
    require(written > 0, "a file in memory can be written");
    content = content.subspan(static_cast<std::size_t>(written));
  }
}

}  // namespace vkopple::fuzz
