#pragma once

#include <array>
#include <cstdint>

namespace vkopple {

/// Ten rounds of Philox 4x32 (Salmon, Moraes, Dror, Shaw: "Parallel random numbers: as easy as 1, 2, 3", 2011):
/// a function of counter and key, so that any draw can be had without those before it, the same on every
/// machine.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

/// One stream of random numbers of a seed. Streams of different numbers or seeds are independent.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream);

  std::uint32_t bits();
  /// In [0, 1), all 53 bits of it.
  double uniform();
  double between(double lowest, double highest) { return lowest + (highest - lowest) * uniform(); }
  /// In 0 ... count - 1; count at least 1.
  std::uint32_t below(std::uint32_t count);

 private:
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> block_{};
  unsigned used_ = 4;
};

}  // namespace vkopple
