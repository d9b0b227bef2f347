#include "train/report/axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace vkopple {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::Pointwise;

std::vector<std::string> labels(const Axis& axis) {
  std::vector<std::string> all;
  for (const double tick : axis.ticks()) all.push_back(axis.label(tick));
  return all;
}

TEST(Axis, LinearTicksAreRound) {
  EXPECT_THAT(labels(Axis::linear(0, 60, 4)), ElementsAre("0", "20", "40", "60"));
  EXPECT_THAT(labels(Axis::linear(-0.13, 0.31)),
              ElementsAre("−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3", "0.4"));
  EXPECT_THAT(labels(Axis::linear(0.031, 0.0412)), ElementsAre("0.030", "0.035", "0.040", "0.045"));
  EXPECT_THAT(labels(Axis::linear(3, 1)), ElementsAre("1.0", "1.5", "2.0", "2.5", "3.0"));
  EXPECT_THAT(labels(Axis::linear(0, 3e6)), ElementsAre("0", "1e+06", "2e+06", "3e+06"));
}

TEST(Axis, WithinItsEndsNeedNotBeRound) {
  const Axis axis = Axis::within(0, 50, 4);
  EXPECT_THAT(labels(axis), ElementsAre("0", "20", "40"));
  EXPECT_EQ(axis.high(), 50);
  EXPECT_DOUBLE_EQ(axis.place(25), 0.5);
}

TEST(Axis, ASingleValueHasAnAxisToo) {
  for (const double value : {0.0, 5.0, -1e-9, 1e12}) {
    const Axis axis = Axis::linear(value, value);
    EXPECT_LT(axis.low(), value);
    EXPECT_GT(axis.high(), value);
    EXPECT_GE(axis.ticks().size(), 3U);
    EXPECT_LE(axis.ticks().size(), 9U);
  }
}

TEST(Axis, LogarithmicTicksAreOfEveryPowerThatThereIsRoomFor) {
  EXPECT_THAT(labels(Axis::logarithmic(0.3, 4)), ElementsAre("0.2", "0.5", "1", "2", "5"));
  EXPECT_THAT(labels(Axis::logarithmic(3.7, 0.02)), ElementsAre("0.01", "0.1", "1", "10"));
  EXPECT_THAT(Axis::logarithmic(1e-5, 1e9).ticks(),
              Pointwise(DoubleEq(), std::vector<double>{1e-5, 1e-2, 1e1, 1e4, 1e7, 1e10}));
}

TEST(Axis, NumbersBeyondReasonHaveAxesToo) {
  for (const Axis& axis :
       {Axis::linear(-1.7e308, 1.7e308), Axis::linear(0, 1e-320), Axis::logarithmic(5e-324, 1),
        Axis::logarithmic(1e-300, 1e300), Axis::fitting(1e305, 1e305)}) {
    EXPECT_GE(axis.ticks().size(), 3U);
    EXPECT_LE(axis.ticks().size(), 9U);
    EXPECT_TRUE(std::isfinite(axis.place(5e-324)));
    for (const double tick : axis.ticks()) EXPECT_TRUE(std::isfinite(tick));
    EXPECT_FALSE(axis.label(axis.low()).empty());
  }
}

TEST(Axis, FittingLooksAtTheRange) {
  EXPECT_TRUE(Axis::fitting(0.1, 4).is_logarithmic());
  EXPECT_FALSE(Axis::fitting(0.1, 2).is_logarithmic());
  EXPECT_FALSE(Axis::fitting(0, 1000).is_logarithmic());
  EXPECT_FALSE(Axis::fitting(-5, -0.01).is_logarithmic());
}

TEST(Axis, Places) {
  const Axis linear = Axis::linear(0, 60, 4);
  EXPECT_DOUBLE_EQ(linear.place(15), 0.25);
  EXPECT_DOUBLE_EQ(linear.place(75), 1.25);
  EXPECT_DOUBLE_EQ(Axis::linear(-3, 1).place(0), 0.75);
  const Axis logarithmic = Axis::logarithmic(0.01, 100);
  EXPECT_DOUBLE_EQ(logarithmic.place(1), 0.5);
  EXPECT_DOUBLE_EQ(logarithmic.place(0.1), 0.25);
}

}  // namespace
}  // namespace vkopple
