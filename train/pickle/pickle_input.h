#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace vkopple {

/// The bytes of a pickle, read from front to back. What is cut off is an Error with source and place.
class PickleInput {
 public:
  PickleInput(std::span<const std::byte> bytes, std::string source)
      : bytes_(bytes), source_(std::move(source)) {}

  /// Starts the next instruction, whose place errors name from here on.
  std::uint8_t opcode();
  std::size_t left() const { return bytes_.size() - offset_; }

  std::uint64_t little(std::size_t bytes);  ///< unsigned, of 1 to 8 bytes
  double big_double();
  std::string_view take(std::uint64_t count);
  std::string_view counted(std::size_t length_bytes) { return take(little(length_bytes)); }
  std::string_view line();  ///< without its '\n'

  /// Throws an Error: "SOURCE: byte 12: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::span<const std::byte> bytes_;
  std::string source_;
  std::size_t offset_ = 0;
  std::size_t opcode_offset_ = 0;
};

}  // namespace vkopple
