#pragma once

#include <cstddef>

#include "tests/fuzz/fuzz.h"

namespace vkopple::fuzz {

/// A copy of some bytes between pages that may not be touched: reading before their first, or behind their
/// last, ends the process, whatever code does it.
class GuardedCopy {
 public:
  enum class Edge { kFirst, kLast };  ///< one of them lies next to its page; there are two copies to make

  GuardedCopy(Input bytes, Edge edge);
  ~GuardedCopy();
  GuardedCopy(const GuardedCopy&) = delete;
  GuardedCopy& operator=(const GuardedCopy&) = delete;

  Input bytes() const { return copy_; }

 private:
  void* pages_;
  std::size_t length_;
  Input copy_;
};

}  // namespace vkopple::fuzz
