#include "train/progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>

namespace vkopple {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

std::string text_of(std::FILE* file) {
  std::rewind(file);
  std::array<char, 4096> text{};
  return {text.data(), std::fread(text.data(), 1, text.size(), file)};
}

StepRecord record(uint64_t step) {
  return {.step = step, .stage = "all", .batch = 4, .losses = {{"image", 0.5}, {"total", 0.25}}, .seconds = 2};
}

TEST(Progress, Durations) {
  EXPECT_EQ(duration_text(0), "0:00");
  EXPECT_EQ(duration_text(59.6), "1:00");
  EXPECT_EQ(duration_text(3723), "1:02:03");
  EXPECT_EQ(duration_text(2 * 86400 + 60), "2 d 0:01:00");
}

TEST(Progress, ALineTellsAll) {
  EXPECT_EQ(progress_line(record(10), 100, 2), "10/100 all  total 0.25  image 0.5  2 triplets/s  3:00 left");
  StepRecord measured = record(100);
  measured.held_out = {.ari_fg = 0.125, .iou = {}, .depth_r = 0.5};
  EXPECT_EQ(progress_line(measured, 100, 2),
            "100/100 all  total 0.25  image 0.5  ARI-fg 0.125  depth r 0.500  2 triplets/s  0:00 left");
}

TEST(Progress, SkippedStepsAreCounted) {
  StepRecord later = record(10);
  later.skipped_steps = 3;
  EXPECT_EQ(progress_line(later, 100, 2),
            "10/100 all  total 0.25  image 0.5  3 skipped  2 triplets/s  3:00 left");
}

TEST(Progress, StageAndScoresMayHaveColours) {
  StepRecord measured = record(100);
  measured.held_out = {.ari_fg = {}, .iou = 0.25, .depth_r = 0.5};
  EXPECT_EQ(progress_line(measured, 100, 2, Colours(true)),
            "100/100 \033[36mall\033[0m  total 0.25  image 0.5  \033[32mIoU 0.250\033[0m  \033[32mdepth r "
            "0.500\033[0m"
            "  2 triplets/s  0:00 left");
  const std::unique_ptr<std::FILE, Close> file(std::tmpfile());
  ASSERT_TRUE(file);
  Progress(file.get(), false, 100).show(measured);
  EXPECT_EQ(text_of(file.get()).find("\033[3"), std::string::npos);
  Progress(file.get(), true, 100, Colours(true)).show(measured);
  EXPECT_NE(text_of(file.get()).find("\033[36mall"), std::string::npos);
}

TEST(Progress, ATerminalsLineIsRewritten) {
  const std::unique_ptr<std::FILE, Close> file(std::tmpfile());
  ASSERT_TRUE(file);
  {
    Progress progress(file.get(), true, 3);
    progress.show(record(1));
    progress.show(record(2));
    progress.say("saved");
  }
  const std::string text = text_of(file.get());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 2);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_NE(text.find("left\033[K\nsaved\n"), std::string::npos) << text;
}

TEST(Progress, ElsewhereFewLines) {
  const std::unique_ptr<std::FILE, Close> file(std::tmpfile());
  ASSERT_TRUE(file);
  Progress progress(file.get(), false, 5);
  for (uint64_t step = 1; step <= 5; ++step) progress.show(record(step));
  const std::string text = text_of(file.get());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_EQ(text.find("1/5"), 0U);
  EXPECT_NE(text.find("\n5/5"), std::string::npos);
}

}  // namespace
}  // namespace vkopple
