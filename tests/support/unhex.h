#pragma once

#include <charconv>
#include <cstddef>
#include <string_view>
#include <vector>

namespace vkopple::test {

/// The bytes of pairs of hexadecimal digits.
inline std::vector<std::byte> unhex(std::string_view digits) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    unsigned char byte = 0;
    std::from_chars(digits.data() + i, digits.data() + i + 2, byte, 16);
    bytes.push_back(std::byte{byte});
  }
  return bytes;
}

}  // namespace vkopple::test
