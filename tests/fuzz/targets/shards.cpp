#include <algorithm>
#include <cstdio>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"
#include "train/shards.h"

namespace vkopple::fuzz {
namespace {

constexpr std::size_t kBlock = 512, kSumAt = 148, kSumBytes = 8, kMagicAt = 257, kEnd = 1024;

/// Makes the sums of what look like headers right, past which few inputs would come.
void mend(std::span<std::byte> block) {
  if (text_of(block.subspan(kMagicAt, 5)) != "ustar") return;
  std::fill_n(block.begin() + kSumAt, kSumBytes, std::byte{' '});
  unsigned sum = 0;
  for (const std::byte b : block) sum += std::to_integer<unsigned>(b);
  char digits[kSumBytes];
  std::snprintf(digits, sizeof digits, "%06o", sum);
  std::transform(digits, digits + kSumBytes - 1, block.begin() + kSumAt, [](char c) { return std::byte(c); });
}

}  // namespace

void shards(Input input) {
  std::vector<std::byte> tar(input.begin(), input.end());
  for (std::size_t at = 0; at + kBlock <= tar.size(); at += kBlock) mend(std::span(tar).subspan(at, kBlock));
  tar.resize((tar.size() + kBlock - 1) / kBlock * kBlock + kEnd);
  const InputFile stored(tar);
  ShardReader places(stored.path());
  tolerate([&] {
    while (const auto place = places.next_place()) places.read(*place);
  });
  ShardReader samples(stored.path());
  while (samples.next()) {
  }
}

}  // namespace vkopple::fuzz
