#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace vkopple {

/// Do these bytes begin as every EXR does?
bool looks_like_exr(std::span<const std::byte> bytes);

/// What is wrong with an EXR's headers, or an empty string: every attribute must lie within the bytes, and
/// the window of its data and its tiles must be no larger than pictures may be. (The decoder takes memory for
/// whatever a header announces, before it looks whether it is there.)
std::string exr_fault(std::span<const std::byte> bytes);

}  // namespace vkopple
