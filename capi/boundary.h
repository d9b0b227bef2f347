#pragma once

#include <exception>
#include <new>
#include <string>

#include "capi/vkopple.h"
#include "runtime/error.h"

namespace vkopple::capi {

/// What vkopple_last_error() tells in this thread.
std::string& last_error() noexcept;

/// Keeps a message, or a shorter one where there is no memory for it.
void keep_error(const char* message) noexcept;

/// Does the work of an API function: no exception leaves it, what was thrown becomes a status and the thread's
/// message.
template <class Work>
vkopple_status guarded(Work&& work) noexcept {
  try {
    last_error().clear();
    work();
    return VKOPPLE_OK;
  } catch (const UsageError& error) {
    keep_error(error.what());
    return VKOPPLE_WRONG_USE;
  } catch (const std::bad_alloc&) {
    keep_error("out of memory; use a smaller image");
    return VKOPPLE_OUT_OF_MEMORY;
  } catch (const std::exception& error) {
    keep_error(error.what());
    return VKOPPLE_FAILED;
  } catch (...) {
    keep_error("an error of unknown kind");
    return VKOPPLE_FAILED;
  }
}

}  // namespace vkopple::capi
