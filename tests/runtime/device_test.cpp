#include "runtime/device.h"

#include <gtest/gtest.h>

#include "tests/support/device_features.h"

namespace vkopple {
namespace {

TEST(DeviceTest, AsksForRobustBufferAccess) {
  const Device device({.use_cache = false});
  EXPECT_EQ(test::features_asked_for().robustBufferAccess, VK_TRUE);
}

}  // namespace
}  // namespace vkopple
