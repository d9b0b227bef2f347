#include "train/file_system.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

namespace vkopple {

FileDescriptor FileSystem::open(const char* path, int flags) {
  constexpr mode_t kAsUmaskHasIt = 0666;
  return FileDescriptor(::open(path, flags | O_CLOEXEC, kAsUmaskHasIt));
}

ssize_t FileSystem::write(int file, const void* bytes, std::size_t count) {
  return ::write(file, bytes, count);
}

int FileSystem::sync(int file) { return ::fsync(file); }

int FileSystem::close(FileDescriptor& file) { return file.close() ? 0 : -1; }

int FileSystem::rename(const char* from, const char* to) { return ::rename(from, to); }

int FileSystem::unlink(const char* path) { return ::unlink(path); }

FileSystem& system_files() {
  static FileSystem files;
  return files;
}

}  // namespace vkopple
