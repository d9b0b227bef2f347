#include "train/colours.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>

#include "tests/support/variable.h"

namespace vkopple {
namespace {

using test::Variable;

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

/// The side of a new terminal that programs write to, and the other.
struct Terminal {
  File keyboard{::fdopen(::posix_openpt(O_RDWR | O_NOCTTY), "r+")};
  File screen;

  Terminal() {
    if (!keyboard || ::grantpt(::fileno(keyboard.get())) != 0 || ::unlockpt(::fileno(keyboard.get())) != 0)
      return;
    screen.reset(std::fopen(::ptsname(::fileno(keyboard.get())), "w"));
  }
};

TEST(Colours, OnATerminalUnlessRefused) {
  const Terminal terminal;
  if (!terminal.screen) GTEST_SKIP() << "no pseudo-terminal can be opened here";
  const Variable term("TERM", "xterm"), none("NO_COLOR", nullptr);
  EXPECT_TRUE(may_have_colours(terminal.screen.get()));
  {
    const Variable refused("NO_COLOR", "0");
    EXPECT_FALSE(may_have_colours(terminal.screen.get())) << "any text refuses";
  }
  {
    const Variable empty("NO_COLOR", "");
    EXPECT_TRUE(may_have_colours(terminal.screen.get()));
  }
  const Variable other("TERM", "dumb");
  EXPECT_FALSE(may_have_colours(terminal.screen.get()));
  EXPECT_TRUE(is_terminal(terminal.screen.get()));
}

TEST(Colours, NoneElsewhere) {
  const Variable term("TERM", "xterm"), none("NO_COLOR", nullptr);
  const File file(std::tmpfile());
  ASSERT_TRUE(file);
  EXPECT_FALSE(may_have_colours(file.get()));
  EXPECT_EQ(Colours(false).stage("depth"), "depth");
  EXPECT_EQ(Colours(true).stage("depth"), "\033[36mdepth\033[0m");
}

}  // namespace
}  // namespace vkopple
