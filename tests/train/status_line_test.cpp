#include "train/status_line.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

namespace vkopple {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

std::string text_of(const File& file) {
  std::rewind(file.get());
  std::array<char, 4096> text{};
  return {text.data(), std::fread(text.data(), 1, text.size(), file.get())};
}

TEST(StatusLine, WithoutATerminalOnlyWhatIsDue) {
  const File file(std::tmpfile());
  ASSERT_TRUE(file);
  StatusLine line(file.get(), false);
  line.show("soon");
  line.show("asked for", true);
  line.clear();
  line.say("stays");
  EXPECT_EQ(text_of(file), "asked for\nstays\n");
}

TEST(StatusLine, ColoursTakeNoColumns) {
  const std::string line = "ab\033[36mcd\033[0mef";
  EXPECT_EQ(cut_to_columns(line, 6), line);
  EXPECT_EQ(cut_to_columns(line, 9), line);
  EXPECT_EQ(cut_to_columns(line, 3), "ab\033[36mc\033[0m");
  EXPECT_EQ(cut_to_columns(line, 5), "ab\033[36mcd\033[0me\033[0m");
  EXPECT_EQ(cut_to_columns(line, 1), "a");
  EXPECT_EQ(cut_to_columns("\033[36", 2), "\033[") << "no colour";
  EXPECT_EQ(cut_to_columns("", 2), "");
}

TEST(StatusLine, OnATerminalItGoesAway) {
  const File file(std::tmpfile());
  ASSERT_TRUE(file);
  StatusLine line(file.get(), true);
  line.show("one");
  line.show(std::string(500, 'x'));
  line.clear();
  line.clear();
  const std::string text = text_of(file);
  EXPECT_EQ(text.find("\rone\033[K\rxxx"), 0U);
  EXPECT_EQ(text.substr(text.size() - 4), "\r\033[K");
  EXPECT_LT(text.size(), 120U);
}

}  // namespace
}  // namespace vkopple
