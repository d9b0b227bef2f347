#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "capi/vkopple.h"
#include "runtime/error.h"

namespace vkopple::capi {

// Structures that begin with struct_size: callers of any version have them begin alike, and know of members up
// to that size. `first` is the size that the first version had, up to the end of its last member.

/// Throws UsageError where no version of the structure has that size, or a version after this one.
template <class T>
void require_struct_size(size_t given, size_t first, const char* name) {
  if (given < first)
    throw UsageError(
        fmt::format("{}.struct_size is {}, and {} at least: set it to sizeof({})", name, given, first, name));
  // Its caller may say things that this library would overlook, or wait for some that it doesn't tell.
  if (given > sizeof(T))
    throw UsageError(fmt::format(
        "{}.struct_size is {}, and {} at most in vkopple {}: build against that version's header, or "
        "use a newer library",
        name, given, sizeof(T), vkopple_version()));
}

/// What a caller gave; members that it doesn't know are those of `standard`.
template <class T>
T read_struct(const T* given, T standard, size_t first, const char* name) {
  const size_t size = given->struct_size;
  require_struct_size<T>(size, first, name);
  std::memcpy(&standard, given, std::min(size, sizeof(T)));
  standard.struct_size = sizeof(T);
  return standard;
}

/// Gives a caller the members that it knows.
template <class T>
void write_struct(T* to, T value, size_t first, const char* name) {
  const size_t size = to->struct_size;
  require_struct_size<T>(size, first, name);
  value.struct_size = size;
  std::memcpy(to, &value, std::min(size, sizeof(T)));
}

}  // namespace vkopple::capi
