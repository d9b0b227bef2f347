#include "train/file_descriptor.h"

#include <unistd.h>

namespace vkopple {

FileDescriptor::~FileDescriptor() { close(); }

bool FileDescriptor::close() {
  const int fd = std::exchange(fd_, -1);
  return fd < 0 || ::close(fd) == 0;
}

}  // namespace vkopple
