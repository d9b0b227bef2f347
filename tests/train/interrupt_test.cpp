#include "train/interrupt.h"

#include <gtest/gtest.h>

#include <csignal>

namespace vkopple {
namespace {

TEST(Interrupt, TheFirstSignalRaisesTheFlag) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Interrupt interrupt;
    EXPECT_FALSE(interrupt.requested());
    std::raise(signal);
    EXPECT_TRUE(interrupt.requested());
  }
}

TEST(InterruptDeathTest, TheSecondEndsTheProgram) {
  const auto twice = [] {
    const Interrupt interrupt;
    std::raise(SIGINT);
    std::raise(SIGINT);
  };
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // others have threads by now
  EXPECT_EXIT(twice(), testing::KilledBySignal(SIGINT), "");
}

TEST(Interrupt, PutsBackWhatWasThere) {
  const auto before = std::signal(SIGINT, SIG_IGN);
  { const Interrupt interrupt; }
  EXPECT_EQ(std::signal(SIGINT, before), SIG_IGN);
}

}  // namespace
}  // namespace vkopple
