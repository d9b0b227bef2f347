#include "train/parallel/agreement.h"

#include <gtest/gtest.h>

#include "runtime/error.h"
#include "tests/support/expect_error.h"
#include "tests/support/threaded_peers.h"
#include "train/parallel/own_device.h"

namespace vkopple {
namespace {

TEST(Agreement, AnyIsAny) {
  EXPECT_TRUE(any(nullptr, true));
  EXPECT_FALSE(any(nullptr, false));
  test::run_together(3, [](Peers& peers) {
    EXPECT_FALSE(any(&peers, false));
    EXPECT_TRUE(any(&peers, peers.rank() == 2));
  });
}

TEST(Agreement, WhatDiffersIsNamed) {
  require_same(nullptr, "x", "everything");
  test::run_together(2, [](Peers& peers) {
    require_same(&peers, "the same", "configuration");
    test::expect_error([&] { require_same(&peers, peers.rank() == 0 ? "this" : "that", "configuration"); },
                       {"configuration", "same command"});
  });
}

Candidate candidate(const std::string& name, DeviceType type, std::vector<std::string> missing = {}) {
  Candidate c;
  c.caps.name = name;
  c.caps.type = type;
  c.missing = std::move(missing);
  return c;
}

TEST(OwnDevice, ProcessesDealTheBestDevicesRound) {
  const std::vector<Candidate> four{candidate("cpu", DeviceType::kCpu), candidate("one", DeviceType::kDiscrete),
                                    candidate("old", DeviceType::kDiscrete, {"Vulkan 1.1"}),
                                    candidate("two", DeviceType::kDiscrete)};
  for (const char* any_device : {"auto", ""}) {
    EXPECT_EQ(choose_own_device(four, any_device, 0), 1U);
    EXPECT_EQ(choose_own_device(four, any_device, 1), 3U);
    EXPECT_EQ(choose_own_device(four, any_device, 2), 1U);
  }
  EXPECT_EQ(choose_own_device(four, "cpu", 1), 0U);
  EXPECT_EQ(choose_own_device(four, "two", 0), 3U);
  EXPECT_THROW(choose_own_device(four, "old", 0), UsageError);
}

}  // namespace
}  // namespace vkopple
