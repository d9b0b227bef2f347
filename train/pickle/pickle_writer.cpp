#include "train/pickle/pickle_writer.h"

#include <fmt/format.h>

#include <bit>
#include <utility>

namespace vkopple {

PickleWriter::PickleWriter() : bytes_("\x80\x02") {}

void PickleWriter::text(std::string_view utf8) {
  raw("X");
  little(utf8.size(), 4);
  raw(utf8);
}

void PickleWriter::whole(std::int64_t value) {
  raw("\x8a\x08");
  little(static_cast<std::uint64_t>(value), 8);
}

/// Big-endian, unlike all else.
void PickleWriter::number(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  raw("G");
  for (int shift = 56; shift >= 0; shift -= 8) little(bits >> shift & 255, 1);
}

void PickleWriter::truth(bool value) { raw(value ? "\x88" : "\x89"); }

void PickleWriter::global(std::string_view module, std::string_view name) {
  raw(fmt::format("c{}\n{}\n", module, name));
}

std::string PickleWriter::finish() {
  raw(".");
  return std::move(bytes_);
}

void PickleWriter::little(std::uint64_t number, int bytes) {
  for (int i = 0; i < bytes; ++i) bytes_ += static_cast<char>(static_cast<unsigned char>(number >> 8 * i));
}

}  // namespace vkopple
