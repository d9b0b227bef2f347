#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/buffer.h"

namespace vkopple {

class Device;

/// NaN as float32, and as two float16.
constexpr uint32_t kNaNWord = 0x7fff7fffU;

/// Memory whose every piece lies between two bands of kGuardBytes, for recordings with Bounds::kGuarded: what
/// is written there was written by mistake, and is found; what is read there is NaN, as float32 and as float16.
class GuardedMemory {
 public:
  explicit GuardedMemory(const Device& device);

  /// A piece filled with NaN. `what` names it in messages. Throws as Arena::allocate does.
  Slice allocate(uint64_t bytes, const std::string& what);
  /// One line for each band that has changed since it was allocated or looked at last: "4 bytes changed beside
  /// output 0, the first 8 bytes beyond its end". Bands are mended.
  std::vector<std::string> damage();

 private:
  struct Band {
    Slice slice;
    std::vector<uint32_t> words;  ///< what it holds where nothing wrote there
    std::string piece;
    bool before;  ///< the piece, else after it
  };
  void add_band(const Slice& slice, const std::string& piece, bool before);
  static std::string describe(const Band& band, const std::vector<uint32_t>& found);

  const Device* device_;
  Arena arena_;
  std::vector<Band> bands_;
};

}  // namespace vkopple
