#include "train/tensorboard/event_file.h"

#include <gtest/gtest.h>

#include <chrono>

#include "runtime/error.h"
#include "tests/support/events.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

using test::TempFolder;

TEST(EventFile, TellsItsVersionAndWhereTheRunGoesOn) {
  const TempFolder folder;
  const EventFile file(folder.path(), 41);
  EXPECT_NE(file.path().filename().string().find("tfevents"), std::string::npos);
  const auto events = test::read_events(file.path());
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].file_version(), "brain.Event:2");
  EXPECT_EQ(events[1].session_log().status(), tensorboard::SessionLog::START);
  EXPECT_EQ(events[1].step(), 42);
}

TEST(EventFile, ScalarsOfAStep) {
  const TempFolder folder;
  EventFile file(folder.path(), 0);
  file.add(7, {{"loss/image", 0.5}, {"loss/total", 0.75}});
  const auto events = test::read_events(file.path());  // while the file is open
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[2].step(), 7);
  const double now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  EXPECT_NEAR(events[2].wall_time(), now, 60);
  const auto& values = events[2].summary().values();
  ASSERT_EQ(values.size(), 2);
  EXPECT_EQ(values[0].tag(), "loss/image");
  EXPECT_EQ(values[0].scalar(), 0.5F);
  EXPECT_EQ(values[1].tag(), "loss/total");
  EXPECT_EQ(values[1].scalar(), 0.75F);
}

TEST(EventFile, PicturesArePngs) {
  const TempFolder folder;
  RgbImage image(2, 3);
  image.pixels[4] = 1;
  EventFile file(folder.path(), 0);
  file.add(9, "held_out", image);
  const auto events = test::read_events(file.path());
  ASSERT_EQ(events.size(), 3U);
  const auto& value = events[2].summary().values(0);
  EXPECT_EQ(value.tag(), "held_out");
  EXPECT_EQ(value.picture().height(), 2);
  EXPECT_EQ(value.picture().width(), 3);
  EXPECT_EQ(value.picture().colours(), 3);
  const std::string& png = value.picture().png();
  EXPECT_EQ(decode_png(std::as_bytes(std::span(png)), "event").pixels, image.pixels);
}

TEST(EventFile, ComesLastWhereverTheClockStands) {
  const TempFolder folder;
  write_file(folder / "events.out.tfevents.9999999990.host.1.0", "");  // of a clock that was set back since
  const EventFile second(folder.path(), 3);
  const EventFile third(folder.path(), 4);
  const auto files = test::event_files(folder.path());
  ASSERT_EQ(files.size(), 3U);
  EXPECT_EQ(files[1], second.path());
  EXPECT_EQ(files[2], third.path());
}

TEST(EventFile, AFolderThatIsNotThereIsNamed) {
  const TempFolder folder;
  try {
    EventFile(folder / "none", 0);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("none/events"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace vkopple
