#include "train/parity.h"

#include <gtest/gtest.h>

#include "tests/support/fixture.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

void expect_parity(const Device& device, const std::string& name) {
  const ParityReport report =
      check_parity(device, std::filesystem::path(VKOPPLE_SOURCE_DIR) / "tests/fixtures" / name);
  EXPECT_GT(report.entries.size(), 300U);
  for (const ParityEntry& e : report.entries)
    EXPECT_TRUE(e.passed()) << e.name << ": error " << e.error << ", limit " << e.limit;
}

TEST(ParityTest, Rigid) { expect_parity(test_device(), "rigid.safetensors"); }

TEST(ParityTest, WithoutWarpingAndJensenShannon) { expect_parity(test_device(), "nowarp_js.safetensors"); }

TEST(ParityTest, Train) { expect_parity(test_device(), "train.safetensors"); }

TEST(ParityTest, RigidOnTheOtherAccessPath) {
  if (other_access_device() == nullptr) GTEST_SKIP() << "the device has one access path only: it lacks 64-bit integers";
  expect_parity(*other_access_device(), "rigid.safetensors");
}

}  // namespace
}  // namespace vkopple
