#include "train/crc32c.h"

#include <array>
#include <bit>

namespace vkopple {
namespace {

constexpr std::uint32_t kPolynomial = 0x82f63b78;  // Castagnoli's, bits in reverse
constexpr std::size_t kStride = 8;

/// tables[k][b]: what byte b followed by k zero bytes leaves. With eight of them a loop takes eight bytes at
/// once.
constexpr auto kTables = [] {
  std::array<std::array<std::uint32_t, 256>, kStride> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t rest = byte;
    for (int bit = 0; bit < 8; ++bit) rest = rest >> 1 ^ ((rest & 1) != 0 ? kPolynomial : 0);
    tables[0][byte] = rest;
  }
  for (std::size_t k = 1; k < kStride; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      tables[k][byte] = tables[k - 1][byte] >> 8 ^ tables[0][tables[k - 1][byte] & 0xff];
  return tables;
}();

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t before) {
  std::uint32_t crc = ~before;
  const auto octet = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  std::size_t at = 0;
  for (; at + kStride <= bytes.size(); at += kStride) {
    std::uint32_t next = 0;
    for (std::size_t k = 0; k < kStride; ++k) {
      const std::uint32_t mixed = octet(at + k) ^ (k < 4 ? crc >> 8 * k & 0xff : 0);
      next ^= kTables[kStride - 1 - k][mixed];
    }
    crc = next;
  }
  for (; at < bytes.size(); ++at) crc = crc >> 8 ^ kTables[0][(crc ^ octet(at)) & 0xff];
  return ~crc;
}

std::uint32_t masked_crc32c(std::span<const std::byte> bytes) {
  return std::rotr(crc32c(bytes), 15) + 0xa282ead8U;
}

}  // namespace vkopple
