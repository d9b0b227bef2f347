#include "train/append_file.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "runtime/error.h"
#include "train/write_advice.h"

namespace vkopple {

AppendFile::AppendFile(std::filesystem::path path, FileSystem& files)
    : path_(std::move(path)), files_(&files), file_(files.open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND)) {
  if (!file_.is_open()) fail(errno);
}

void AppendFile::add(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = files_->write(file_.get(), text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void AppendFile::fail(int code) const {
  throw Error(fmt::format("{}: cannot be written: {}{}", path_.string(), std::generic_category().message(code),
                          write_advice(code)));
}

}  // namespace vkopple
