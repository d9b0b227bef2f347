#include "train/crc32c.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace vkopple {
namespace {

std::uint32_t of(std::string_view text) { return crc32c(std::as_bytes(std::span(text))); }

std::vector<std::byte> counting(int first, int step) {
  std::vector<std::byte> bytes(32);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::byte>(first + step * static_cast<int>(i));
  return bytes;
}

// RFC 3720, appendix B.4, which prints the bytes in the order of the wire.
TEST(Crc32c, ExamplesOfTheRfc) {
  EXPECT_EQ(crc32c(std::vector(32, std::byte{0})), 0x8a9136aau);
  EXPECT_EQ(crc32c(std::vector(32, std::byte{0xff})), 0x62a8ab43u);
  EXPECT_EQ(crc32c(counting(0, 1)), 0x46dd794eu);
  EXPECT_EQ(crc32c(counting(31, -1)), 0x113fdb5cu);
  std::vector<std::byte> command(48, std::byte{0});  // an iSCSI read command
  const auto put = [&](std::size_t at, int value) { command[at] = static_cast<std::byte>(value); };
  put(0, 0x01), put(1, 0xc0), put(16, 0x14), put(22, 0x04), put(27, 0x14), put(31, 0x18), put(32, 0x28),
      put(40, 0x02);
  EXPECT_EQ(crc32c(command), 0xd9963a56u);
}

TEST(Crc32c, OfNothingAndOfDigits) {
  EXPECT_EQ(of(""), 0u);
  EXPECT_EQ(of("123456789"), 0xe3069283u);  // the check value by which polynomials are listed
}

TEST(Crc32c, EveryLengthAgreesWithTheDefinition) {
  std::vector<std::byte> bytes;
  for (unsigned i = 0; i < 40; ++i) {
    std::uint32_t crc = 0xffffffff;  // bit by bit
    for (const std::byte byte : bytes) {
      crc ^= std::to_integer<std::uint32_t>(byte);
      for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82f63b78u : 0u);
    }
    EXPECT_EQ(crc32c(bytes), ~crc) << bytes.size() << " bytes";
    bytes.push_back(static_cast<std::byte>(i * 37 + 11));
  }
}

TEST(Crc32c, PiecesGiveWhatTheWholeGives) {
  const std::vector<std::byte> bytes = counting(3, 7);
  const std::span all(bytes);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut)
    EXPECT_EQ(crc32c(all.subspan(cut), crc32c(all.first(cut))), crc32c(all)) << cut;
}

TEST(Crc32c, MaskRotatesAndAdds) {
  // Of 32 zeros: 0x8a9136aa turned right by 15 bits is 0x6d551522.
  EXPECT_EQ(masked_crc32c(std::vector(32, std::byte{0})), 0x6d551522u + 0xa282ead8u);
}

}  // namespace
}  // namespace vkopple
