#include "train/random.h"

namespace vkopple {
namespace {

std::uint32_t low(std::uint64_t x) { return static_cast<std::uint32_t>(x); }
std::uint32_t high(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); }

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> c, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t even = std::uint64_t{0xD2511F53} * c[0];
    const std::uint64_t odd = std::uint64_t{0xCD9E8D57} * c[2];
    c = {high(odd) ^ c[1] ^ key[0], low(odd), high(even) ^ c[3] ^ key[1], low(even)};
    key[0] += 0x9E3779B9;
    key[1] += 0xBB67AE85;
  }
  return c;
}

Random::Random(std::uint64_t seed, std::uint64_t stream)
    : key_{low(seed), high(seed)}, counter_{0, 0, low(stream), high(stream)} {}

std::uint32_t Random::bits() {
  if (used_ == block_.size()) {
    block_ = philox(counter_, key_);
    if (++counter_[0] == 0) ++counter_[1];
    used_ = 0;
  }
  return block_[used_++];
}

double Random::uniform() {
  const std::uint64_t upper = bits() >> 5;  // 27 bits and 26 more
  const std::uint64_t lower = bits() >> 6;
  return static_cast<double>(upper << 26 | lower) * 0x1p-53;
}

std::uint32_t Random::below(std::uint32_t count) {
  // The bias of one multiplication is below count / 2^32: nothing for the small counts that rooms and shuffles
  // need.
  return high(std::uint64_t{bits()} * count);
}

}  // namespace vkopple
