#include "train/exr_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "train/image_io.h"

namespace vkopple {
namespace {

std::vector<std::byte> picture() { return encode_exr({Plane<float>(3, 5), Plane<std::uint32_t>(3, 5)}); }

/// The picture with numbers of the attribute's value replaced.
std::vector<std::byte> with(const std::string& name, const std::string& type,
                            const std::vector<std::int32_t>& numbers) {
  std::vector<std::byte> bytes = picture();
  const std::string start = name + '\0' + type + '\0';
  const auto chars = std::as_bytes(std::span(start));
  const auto found = std::search(bytes.begin(), bytes.end(), chars.begin(), chars.end());
  EXPECT_NE(found, bytes.end()) << name;
  const auto at = static_cast<std::size_t>(found - bytes.begin()) + start.size() + 4;
  std::memcpy(bytes.data() + at, numbers.data(), 4 * numbers.size());
  return bytes;
}

TEST(ExrCheck, TakesWhatIsWritten) {
  EXPECT_TRUE(looks_like_exr(picture()));
  EXPECT_EQ(exr_fault(picture()), "");
  EXPECT_EQ(exr_fault(encode_depth_exr(Plane<float>(1, 1))), "");
  EXPECT_EQ(exr_fault(with("dataWindow", "box2i", {-3, -3, 1, -1})), "");
}

TEST(ExrCheck, RefusesHeadersThatAreCutOff) {
  const std::vector<std::byte> whole = picture();
  // The header ends where an empty name stands behind the last attribute, screenWindowWidth.
  const std::string last = std::string("screenWindowWidth\0float\0", 24);
  const auto chars = std::as_bytes(std::span(last));
  const auto found = std::search(whole.begin(), whole.end(), chars.begin(), chars.end());
  ASSERT_NE(found, whole.end());
  const auto end = static_cast<std::size_t>(found - whole.begin()) + last.size() + 4 + 4;
  for (std::size_t length = 0; length <= end; ++length)
    EXPECT_NE(exr_fault(std::span(whole).first(length)), "") << length;
  EXPECT_FALSE(looks_like_exr(std::span(whole).first(3)));
}

TEST(ExrCheck, RefusesSizesThatNoPictureHas) {
  for (const std::vector<std::int32_t>& window :
       std::vector<std::vector<std::int32_t>>{{0, 0, -1, 0},
                                              {0, 0, 0, -1},
                                              {0, 0, 16384, 0},
                                              {0, 0, 0, 16384},
                                              {0, 0, 9999, 9999},
                                              {INT32_MIN, 0, INT32_MAX, 0}})
    EXPECT_EQ(exr_fault(with("dataWindow", "box2i", window)), "the EXR's window is empty or too large");
}

TEST(ExrCheck, LooksAtTheHeadersOfAllParts) {
  const std::string attribute = std::string("a\0int\0\4\0\0\0", 10) + "1234";
  const std::string head = std::string("\x76\x2f\x31\x01\x02\x10\0\0", 8);
  const auto fault = [](const std::string& text) { return exr_fault(std::as_bytes(std::span(text))); };
  const std::string end(1, '\0');
  EXPECT_EQ(fault(head + attribute + end + attribute + end + end), "");
  EXPECT_NE(fault(head + attribute + end + attribute + end), "");
  const std::string tiles = std::string("tiles\0tiledesc\0\x09\0\0\0", 19);
  EXPECT_EQ(fault(head + attribute + end + tiles + std::string("\x40\0\0\0\x40\0\0\0\0", 9) + end + end), "");
  EXPECT_EQ(fault(head + attribute + end + tiles + std::string("\0\0\0\x40\x40\0\0\0\0", 9) + end + end),
            "the EXR's tiles are empty or too large");
}

}  // namespace
}  // namespace vkopple
