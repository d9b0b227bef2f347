#include "train/pickle/pickle_input.h"

#include <fmt/format.h>

#include <bit>

#include "runtime/error.h"

namespace vkopple {

std::uint8_t PickleInput::opcode() {
  opcode_offset_ = offset_;
  if (left() == 0) fail("it ends without the instruction to stop; it is cut off, fetch or write it again");
  return static_cast<std::uint8_t>(bytes_[offset_++]);
}

std::string_view PickleInput::take(std::uint64_t count) {
  if (count > left())
    fail(fmt::format("{} bytes are announced, {} are left; it is cut off or damaged", count, left()));
  const auto* text = reinterpret_cast<const char*>(bytes_.data() + offset_);
  offset_ += static_cast<std::size_t>(count);
  return {text, static_cast<std::size_t>(count)};
}

std::uint64_t PickleInput::little(std::size_t bytes) {
  const std::string_view text = take(bytes);
  std::uint64_t value = 0;
  for (std::size_t i = bytes; i-- > 0;) value = value << 8 | static_cast<std::uint8_t>(text[i]);
  return value;
}

double PickleInput::big_double() {
  std::uint64_t bits = 0;
  for (const char byte : take(sizeof bits)) bits = bits << 8 | static_cast<std::uint8_t>(byte);
  return std::bit_cast<double>(bits);
}

std::string_view PickleInput::line() {
  const std::string_view rest(reinterpret_cast<const char*>(bytes_.data() + offset_), left());
  const std::size_t length = rest.find('\n');
  if (length == std::string_view::npos) fail("a line without an end; it is cut off or damaged");
  offset_ += length + 1;
  return rest.substr(0, length);
}

void PickleInput::fail(const std::string& what) const {
  throw Error(fmt::format("{}: byte {}: {}", source_, opcode_offset_, what));
}

}  // namespace vkopple
