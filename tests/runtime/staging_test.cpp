#include "runtime/staging.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "runtime/device.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

// Devices that share the host's memory never stage; here they do, as a discrete GPU would.
class StagingTest : public testing::Test {
 protected:
  std::vector<uint32_t> there_and_back(size_t words, size_t at) {
    std::vector<uint32_t> sent(words);
    std::iota(sent.begin(), sent.end(), static_cast<uint32_t>(at));
    const Slice slice = buffer_.whole().sub(at * 4, words * 4);
    staging_.upload(slice, std::as_bytes(std::span(sent)));
    std::vector<uint32_t> received(words);
    staging_.download(slice, std::as_writable_bytes(std::span(received)));
    EXPECT_EQ(received, sent) << words << " words at " << at;
    return sent;
  }

  static constexpr size_t kWords = (size_t{33} << 20) / 4;  // more than is staged at once
  Buffer buffer_{test_device(), kWords * 4, MemoryKind::kDevice, "test"};
  Staging staging_{test_device()};
};

TEST_F(StagingTest, BringsBackWhatItTookThere) {
  there_and_back(1, 7);
  there_and_back(100'000, 64);  // outgrows the first buffer
  there_and_back(3, 1);
  there_and_back(kWords, 0);
}

TEST_F(StagingTest, TouchesNothingBeside) {
  there_and_back(64, 0);
  there_and_back(4, 16);  // the same numbers, had the first been kept
  std::vector<uint32_t> all(64);
  staging_.download(buffer_.whole().sub(0, 256), std::as_writable_bytes(std::span(all)));
  for (uint32_t i = 0; i < 64; ++i) EXPECT_EQ(all[i], i);
}

TEST_F(StagingTest, CopiesWithinTheDevice) {
  const auto sent = there_and_back(64, 0);
  staging_.copy(buffer_.whole().sub(0, 256), buffer_.whole().sub(1024, 256));
  std::vector<uint32_t> received(64);
  staging_.download(buffer_.whole().sub(1024, 256), std::as_writable_bytes(std::span(received)));
  EXPECT_EQ(received, sent);
}

}  // namespace
}  // namespace vkopple
