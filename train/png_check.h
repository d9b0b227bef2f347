#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace vkopple {

/// Do these bytes begin as every PNG does?
bool looks_like_png(std::span<const std::byte> bytes);

/// What is wrong with a PNG's frame, or an empty string: it must begin with the signature and IHDR, be a
/// sequence of whole chunks with right checksums, and end with IEND. The pixels inside IDAT are not looked at.
/// (The decoder finds the same faults, but prints them on standard error.)
std::string png_fault(std::span<const std::byte> bytes);

}  // namespace vkopple
