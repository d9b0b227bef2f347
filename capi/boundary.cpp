#include "capi/boundary.h"

namespace vkopple::capi {

std::string& last_error() noexcept {
  thread_local std::string message;
  return message;
}

void keep_error(const char* message) noexcept {
  try {
    last_error() = message;
  } catch (const std::bad_alloc&) {
    last_error() = "out of memory";  // short enough to need none
  }
}

}  // namespace vkopple::capi
