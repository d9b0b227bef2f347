#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vkopple {

/// The cyclic redundancy check of Castagnoli's polynomial, as RFC 3720 (iSCSI) defines it. `before`: what the
/// bytes that come before these gave, so that a text may be given in pieces.
std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t before = 0);

/// As TFRecord files store it: rotated and moved, so that the check of bytes which hold checks stays useful.
std::uint32_t masked_crc32c(std::span<const std::byte> bytes);

}  // namespace vkopple
