#include "models/identities.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/support/expect_error.h"

namespace vkopple {
namespace {

using Ids = std::vector<std::optional<size_t>>;
constexpr auto kNone = std::nullopt;

/// Codes of two numbers. The objects' own ones are far from each other and from the background's zeros.
using Code = std::array<float, 2>;
constexpr Code kRed{3, 0}, kBlue{0, 3}, kGreen{-3, -3}, kYellow{3, -4};

class IdentitiesTest : public testing::Test {
 protected:
  /// A slot without a code shows nothing.
  Ids follow(const std::vector<std::optional<Code>>& slots) {
    std::vector<float> codes;
    std::vector<bool> visible;
    for (const auto& slot : slots) {
      const Code code = slot.value_or(Code{3, 0});
      codes.insert(codes.end(), code.begin(), code.end());
      visible.push_back(slot.has_value());
    }
    return identities_.follow(codes, visible);
  }

  Identities identities_{2};
};

TEST_F(IdentitiesTest, ObjectsThatSwapTheirSlotsKeepTheirs) {
  EXPECT_EQ(follow({kRed, kBlue, kGreen}), (Ids{0, 1, 2}));
  EXPECT_EQ(follow({kBlue, kGreen, kRed}), (Ids{1, 2, 0}));
  EXPECT_EQ(follow({kGreen, kBlue, kRed}), (Ids{2, 1, 0}));
}

TEST_F(IdentitiesTest, OneThatComesBackIsKnown) {
  EXPECT_EQ(follow({kRed, kBlue, kNone}), (Ids{0, 1, kNone}));
  EXPECT_EQ(follow({kNone, kBlue, kNone}), (Ids{kNone, 1, kNone})) << "though slot 0 still has a code";
  EXPECT_EQ(follow({kGreen, kBlue, kNone}), (Ids{2, 1, kNone}));
  EXPECT_EQ(follow({kNone, kNone, kNone}), (Ids{kNone, kNone, kNone}));
  EXPECT_EQ(follow({kBlue, kYellow, kRed}), (Ids{1, 3, 0}));
}

TEST_F(IdentitiesTest, TheLastCodeCounts) {
  // Two codes go round a circle, each through the place where the other began.
  for (int step = 0; step < 24; ++step) {
    const double angle = 2 * std::numbers::pi * step / 24;
    const auto x = static_cast<float>(3 * std::cos(angle)), y = static_cast<float>(3 * std::sin(angle));
    const Code first{x, y}, second{-y, x};
    if (step % 2 == 0)
      EXPECT_EQ(follow({first, second}), (Ids{0, 1})) << step;
    else
      EXPECT_EQ(follow({second, first}), (Ids{1, 0})) << step;
  }
}

TEST_F(IdentitiesTest, NoneIsGivenTwice) {
  EXPECT_EQ(follow({kRed, kBlue}), (Ids{0, 1}));
  // Both are nearest to red; the second is nearer to blue than to the background.
  EXPECT_EQ(follow({Code{2.5F, 0.5F}, Code{2, 1.9F}}), (Ids{0, 1}));
  // Of two equals one is new, as nothing else is near.
  EXPECT_EQ(follow({kYellow, kYellow}), (Ids{2, 3}));
}

TEST_F(IdentitiesTest, ALargerCodeDoesNotPushOutAnEqualOne) {
  EXPECT_EQ(follow({kRed}), (Ids{0}));
  EXPECT_EQ(follow({Code{5, 1}, kRed}), (Ids{1, 0})) << "though (5, 1) is far nearer to red than to zero";
  EXPECT_EQ(follow({kRed, kGreen, Code{5, 1}}), (Ids{0, 2, 1}));
}

TEST_F(IdentitiesTest, WhatIsNearerToTheBackgroundThanToAnyIsNew) {
  EXPECT_EQ(follow({kRed}), (Ids{0}));
  EXPECT_EQ(follow({Code{1.6F, 0}}), (Ids{0})) << "nearer to (3, 0) than to (0, 0)";
  EXPECT_EQ(follow({kRed}), (Ids{0}));
  EXPECT_EQ(follow({Code{1.4F, 0}}), (Ids{1}));
  EXPECT_EQ(follow({Code{0.8F, 0}}), (Ids{1}));
  EXPECT_EQ(follow({Code{1.7F, 0}}), (Ids{0})) << "0.8 is nearer to zero than to 1.7";
}

TEST_F(IdentitiesTest, RefusesAnotherNumberOfCodes) {
  const std::vector<float> three(3);
  test::expect_error([&] { identities_.follow(three, {true, true}); }, {"number"});
}

}  // namespace
}  // namespace vkopple
