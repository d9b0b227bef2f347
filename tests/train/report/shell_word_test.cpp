#include "train/report/shell_word.h"

#include <gtest/gtest.h>

namespace vkopple {
namespace {

TEST(ShellWord, IsQuotedWhereAShellSeesMore) {
  EXPECT_EQ(shell_word("runs/a-1.safetensors"), "runs/a-1.safetensors");
  EXPECT_EQ(shell_word("rooms:9001"), "rooms:9001");
  EXPECT_EQ(shell_word("my run"), "'my run'");
  EXPECT_EQ(shell_word("$(x)"), "'$(x)'");
  EXPECT_EQ(shell_word("it's"), R"('it'\''s')");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace vkopple
