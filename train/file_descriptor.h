#pragma once

#include <utility>

namespace vkopple {

/// Owns an open POSIX file descriptor, or nothing (-1).
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor();
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }

  int get() const { return fd_; }
  bool is_open() const { return fd_ >= 0; }

  /// Closes now; false (with errno) when the system reports a late write error.
  bool close();

 private:
  int fd_ = -1;
};

}  // namespace vkopple
