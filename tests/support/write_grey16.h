#pragma once

#include <cstdint>
#include <filesystem>

namespace vkopple::test {

/// A picture of 16-bit grey, every pixel of one value.
void write_grey16(const std::filesystem::path& path, int width, int height, std::uint16_t value);

}  // namespace vkopple::test
