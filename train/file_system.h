#pragma once

#include <sys/types.h>

#include <cstddef>

#include "train/file_descriptor.h"

namespace vkopple {

/// What is asked of the system to write files: the calls of POSIX by their names, which fail as those do, with
/// errno. A class of its own so that faults can be put in their place; the program has no other than
/// system_files().
class FileSystem {
 public:
  FileSystem() = default;
  virtual ~FileSystem() = default;
  FileSystem(const FileSystem&) = delete;
  FileSystem& operator=(const FileSystem&) = delete;

  /// Closed where it could not be opened.
  virtual FileDescriptor open(const char* path, int flags);
  virtual ssize_t write(int file, const void* bytes, std::size_t count);
  virtual int sync(int file);
  virtual int close(FileDescriptor& file);
  virtual int rename(const char* from, const char* to);
  virtual int unlink(const char* path);
};

/// The system's own; has no state.
FileSystem& system_files();

}  // namespace vkopple
