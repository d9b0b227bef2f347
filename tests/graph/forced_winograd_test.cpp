#include "graph/conv/convolution.h"

#include <gtest/gtest.h>

#include "runtime/device.h"
#include "runtime/error.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

/// 4 channels: nothing that an estimate gives to Winograd's algorithm.
constexpr ConvShape kSmall{1, 4, 8, 8, 4, 8, 8, 3, 1, 1, 1};
constexpr ConvShape kStride2{1, 4, 8, 8, 4, 4, 4, 3, 2, 1, 1};

Caps caps_with(WinogradUse use) {
  Caps caps;
  caps.name = "made up";
  caps.type = DeviceType::kCpu;
  caps.subgroup_shuffle = true;
  caps.subgroup_size = 8;
  caps.max_storage_range = 1U << 30;
  caps.winograd = use;
  return caps;
}

void expect_all(const ConvShape& shape, const Caps& caps, ConvAlgorithm want) {
  EXPECT_EQ(choose_convolution(shape, ConvDirection::kForward, caps), want);
  EXPECT_EQ(choose_convolution(shape, ConvDirection::kTransposed, caps), want);
  EXPECT_EQ(choose_weight_gradient(shape, caps), want);
}

TEST(ForcedWinograd, RunsWhereItCan) {
  expect_all(kSmall, caps_with(WinogradUse::kWhereFaster), ConvAlgorithm::kDirect);
  expect_all(kSmall, caps_with(WinogradUse::kTiles2), ConvAlgorithm::kWinograd2);
  expect_all(kSmall, caps_with(WinogradUse::kTiles4), ConvAlgorithm::kWinograd4);
  expect_all(kStride2, caps_with(WinogradUse::kTiles2), ConvAlgorithm::kDirect);
}

TEST(ForcedWinograd, LeavesTheOtherChoicesToTheirKernels) {
  Caps caps = caps_with(WinogradUse::kTiles2);
  caps.kernels = KernelFamily::kShared;
  expect_all(kSmall, caps, ConvAlgorithm::kWinograd2);
  caps.type = DeviceType::kDiscrete;
  expect_all(kSmall, caps, ConvAlgorithm::kWinograd2);
  EXPECT_EQ(choose_convolution(kSmall, ConvDirection::kForward, caps, "winograd4"), ConvAlgorithm::kWinograd4);
  EXPECT_EQ(choose_convolution(kSmall, ConvDirection::kForward, caps, "uniform"), ConvAlgorithm::kDirect);
  caps.exact_sums = true;
  expect_all(kSmall, caps, ConvAlgorithm::kDirect);
}

TEST(ForcedWinograd, NeedsShufflesAndPlainSums) {
  Caps caps = caps_with(WinogradUse::kTiles2);
  EXPECT_TRUE(missing_for(WinogradUse::kTiles2, caps).empty());
  caps.subgroup_shuffle = false;
  EXPECT_NE(missing_for(WinogradUse::kTiles2, caps).find("made up"), std::string::npos);
  EXPECT_TRUE(missing_for(WinogradUse::kWhereFaster, caps).empty());
  test::expect_error([] { const Device device({.exact_sums = true, .winograd = WinogradUse::kTiles4}); },
                     {"Winograd"});
}

}  // namespace
}  // namespace vkopple
