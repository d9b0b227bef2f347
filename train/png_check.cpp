#include "train/png_check.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "train/as_text.h"

namespace vkopple {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
constexpr std::size_t kFrameBytes = 12;  // of a chunk: length, type, checksum

std::uint32_t big_endian(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<std::uint32_t>(bytes[i]);
  return value;
}

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    table[i] = i;
    for (int bit = 0; bit < 8; ++bit) table[i] = (table[i] >> 1) ^ ((table[i] & 1) != 0 ? 0xedb88320u : 0);
  }
  return table;
}

/// CRC-32 of IEEE 802.3.
std::uint32_t crc32(std::span<const std::byte> bytes) {
  static constexpr auto kTable = crc_table();
  std::uint32_t crc = ~0u;
  for (const std::byte b : bytes) crc = (crc >> 8) ^ kTable[(crc ^ std::to_integer<std::uint32_t>(b)) & 255];
  return ~crc;
}

}  // namespace

bool looks_like_png(std::span<const std::byte> bytes) { return as_text(bytes).starts_with(kSignature); }

std::string png_fault(std::span<const std::byte> bytes) {
  if (!looks_like_png(bytes)) return "not a PNG";
  bytes = bytes.subspan(kSignature.size());
  bool first = true;
  while (bytes.size() >= kFrameBytes) {
    const std::size_t length = big_endian(bytes);
    if (length > bytes.size() - kFrameBytes) return "the PNG is cut off";
    const auto typed = bytes.subspan(4, 4 + length);
    if (crc32(typed) != big_endian(bytes.subspan(8 + length))) return "the PNG is damaged (wrong checksum)";
    const std::string_view type = as_text(typed.first(4));
    if (first && type != "IHDR") return "the PNG is damaged (no header)";
    if (type == "IEND") return {};
    first = false;
    bytes = bytes.subspan(kFrameBytes + length);
  }
  return "the PNG is cut off";
}

}  // namespace vkopple
