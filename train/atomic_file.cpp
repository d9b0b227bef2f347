#include "train/atomic_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <system_error>

#include "runtime/error.h"
#include "train/quote.h"
#include "train/write_advice.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_writing(const fs::path& target, int code) {
  throw Error(fmt::format("cannot write {}: {}{}", quote(target.string(), 4096),
                          std::generic_category().message(code), write_advice(code)));
}

[[noreturn]] void fail_reading(const fs::path& path, std::string_view reason) {
  throw Error(fmt::format("cannot read {}: {}", quote(path.string(), 4096), reason));
}

/// The file that a name stands for. Renaming over a device or a pipe would replace it, so only files will do.
fs::path resolve_target(const fs::path& target) {
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error(fmt::format("cannot write {}: it exists and is not a regular file; choose another name",
                            quote(target.string(), 4096)));
  }
  if (!fs::is_symlink(fs::symlink_status(target, ignored))) return target;
  std::error_code failed;
  fs::path real = fs::weakly_canonical(target, failed);
  if (failed) fail_writing(target, failed.value());
  return real;
}

template <class Bytes>
Bytes read_whole(const fs::path& path, std::size_t max_bytes) {
  const FileDescriptor file = open_for_reading(path);
  max_bytes = std::min(max_bytes, std::numeric_limits<std::size_t>::max() - 1);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) fail_reading(path, std::generic_category().message(errno));
  // The size is a hint only: the file may grow, and files of /proc claim to be empty.
  const std::size_t hint = std::min(static_cast<std::size_t>(std::max<off_t>(info.st_size, 0)), max_bytes) + 1;
  Bytes bytes;
  bytes.resize(hint);
  std::size_t used = 0;
  while (true) {
    const ssize_t got = ::read(file.get(), bytes.data() + used, bytes.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_reading(path, std::generic_category().message(errno));
    if (got == 0) break;
    used += static_cast<std::size_t>(got);
    if (used > max_bytes) fail_reading(path, fmt::format("it is larger than the {} bytes allowed", max_bytes));
    if (used == bytes.size()) bytes.resize(std::min(2 * used, max_bytes + 1));
  }
  bytes.resize(used);
  return bytes;
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& target, FileSystem& files)
    : files_(&files), target_(resolve_target(target)) {
  constexpr int kAttempts = 1000;  // names taken by remains of a process that died with our number
  for (int n = 0; n < kAttempts && !file_.is_open(); ++n) {
    temporary_ = target_;
    temporary_ += fmt::format(".tmp-{}-{}", ::getpid(), n);
    file_ = files.open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL);
    if (!file_.is_open() && errno != EEXIST) fail_writing(target_, errno);
  }
  if (!file_.is_open()) fail_writing(target_, EEXIST);
}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty()) files_->unlink(temporary_.c_str());
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = files_->write(file_.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_writing(target_, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void AtomicFile::write(std::string_view text) { write(std::as_bytes(std::span(text))); }

void AtomicFile::commit() {
  if (!file_.is_open()) throw Error(fmt::format("{} was already written", quote(target_.string(), 4096)));
  if (files_->sync(file_.get()) != 0) fail_writing(target_, errno);
  if (files_->close(file_) != 0) fail_writing(target_, errno);
  if (files_->rename(temporary_.c_str(), target_.c_str()) != 0) fail_writing(target_, errno);
  temporary_.clear();
  sync_folder();
}

void AtomicFile::sync_folder() const {
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  const FileDescriptor handle = files_->open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  // A folder may be writable but not readable, and some file systems can't sync folders: the file itself is
  // safe.
  if (!handle.is_open()) return;
  if (files_->sync(handle.get()) != 0 && errno == EIO) fail_writing(target_, errno);
}

void write_file(const fs::path& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void write_file(const fs::path& path, std::string_view text) {
  write_file(path, std::as_bytes(std::span(text)));
}

FileDescriptor open_for_reading(const fs::path& path) {
  // O_NONBLOCK: opening a pipe that nobody writes to would wait for ever.
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.is_open()) {
    const int code = errno;
    fail_reading(path, std::generic_category().message(code) + (code == ENOENT   ? "; check the path"
                                                                : code == EACCES ? "; check its permissions"
                                                                                 : ""));
  }
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) fail_reading(path, std::generic_category().message(errno));
  if (!S_ISREG(info.st_mode)) fail_reading(path, "it is not a regular file");
  return file;
}

std::vector<std::byte> read_file(const fs::path& path, std::size_t max_bytes) {
  return read_whole<std::vector<std::byte>>(path, max_bytes);
}

std::string read_text_file(const fs::path& path, std::size_t max_bytes) {
  return read_whole<std::string>(path, max_bytes);
}

}  // namespace vkopple
