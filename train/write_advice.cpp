#include "train/write_advice.h"

#include <cerrno>

namespace vkopple {

std::string_view write_advice(int code) {
  switch (code) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "; free some space or choose another folder";
    case ENOENT:
    case ENOTDIR:
      return "; create the folder or correct the path";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; choose a folder that may be written, or change its permissions";
    case EIO:
      return "; look at the disk, and choose another one";
    default:
      return "";
  }
}

}  // namespace vkopple
