#include "tests/support/faulty_files.h"

#include <signal.h>

#include <cerrno>
#include <utility>

namespace vkopple::test {

bool FaultyFiles::fails(const char* call) {
  const bool struck = fault_ != Fault::kNone && !hit_ && (only_.empty() || only_ == call) && counted_++ == at_;
  const bool later = hit_;
  calls_.emplace_back(call);
  hit_ = hit_ || struck;
  errno = error_;
  if (struck && fault_ == Fault::kFails) return true;
  if (struck && fault_ == Fault::kKilled) throw Killed{};
  if (struck && fault_ == Fault::kSigkill) ::raise(SIGKILL);
  return later && fault_ == Fault::kKilled;
}

FileDescriptor FaultyFiles::open(const char* path, int flags) {
  return fails("open") ? FileDescriptor() : FileSystem::open(path, flags);
}

ssize_t FaultyFiles::write(int file, const void* bytes, std::size_t count) {
  if (fails("write")) return -1;
  if (!hit_ || fault_ != Fault::kFull) return FileSystem::write(file, bytes, count);
  if (!std::exchange(full_, true) && count > 1) return FileSystem::write(file, bytes, count / 2);
  errno = ENOSPC;
  return -1;
}

int FaultyFiles::sync(int file) { return fails("sync") ? -1 : FileSystem::sync(file); }

int FaultyFiles::close(FileDescriptor& file) {
  const bool failed = fails("close");
  const int error = errno;
  const int result = FileSystem::close(file);  // as the system does in any case
  errno = error;
  return failed ? -1 : result;
}

int FaultyFiles::rename(const char* from, const char* to) {
  return fails("rename") ? -1 : FileSystem::rename(from, to);
}

int FaultyFiles::unlink(const char* path) { return fails("unlink") ? -1 : FileSystem::unlink(path); }

}  // namespace vkopple::test
