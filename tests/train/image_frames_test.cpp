#include "train/image_frames.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/film.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

using test::TempFolder;

RgbImage coloured(float red, float green, float blue, int height = 6, int width = 9) {
  RgbImage image(height, width);
  const auto plane = static_cast<std::ptrdiff_t>(height) * width;
  std::fill_n(image.pixels.begin(), plane, red);
  std::fill_n(image.pixels.begin() + plane, plane, green);
  std::fill_n(image.pixels.begin() + 2 * plane, plane, blue);
  return image;
}

/// A picture each of red, green and blue.
std::vector<RgbImage> three() { return {coloured(1, 0, 0), coloured(0, 1, 0), coloured(0, 0, 1)}; }

std::vector<RgbImage> all(ImageFrames& frames) {
  std::vector<RgbImage> images;
  while (auto image = frames.next()) images.push_back(std::move(*image));
  EXPECT_FALSE(frames.next()) << "once it is at its end it stays there";
  return images;
}

void expect_three(const std::filesystem::path& path) {
  ImageFrames frames(path);
  EXPECT_TRUE(frames.film());
  const auto images = all(frames);
  ASSERT_EQ(images.size(), 3U);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(images[i].height, 6);
    EXPECT_EQ(images[i].width, 9);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(images[i].pixels.at(6 * 9 * c), i == c ? 1 : 0, 0.02) << i << c;
  }
}

TEST(ImageFrames, OfAnAnimation) {
  const TempFolder folder;
  test::write_film(folder / "a.gif", three());
  expect_three(folder / "a.gif");
  EXPECT_FALSE(ImageFrames(folder / "a.gif").count());
}

TEST(ImageFrames, OfPages) {
  const TempFolder folder;
  test::write_film(folder / "a.tif", three());
  expect_three(folder / "a.tif");
}

TEST(ImageFrames, OfAVideo) {
  if (!test::reads_videos()) GTEST_SKIP() << "this build of OpenImageIO reads no videos";
  const TempFolder folder;
  test::write_avi(folder / "a.avi", three());
  expect_three(folder / "a.avi");
  EXPECT_EQ(ImageFrames(folder / "a.avi").count(), 3U);
}

TEST(ImageFrames, OneOfOtherFiles) {
  const TempFolder folder;
  write_png(folder / "a.png", coloured(1, 0, 0));
  test::write_film(folder / "a.gif", {coloured(1, 0, 0)});
  test::write_film(folder / "a.tif", {coloured(1, 0, 0)});
  for (const auto* name : {"a.png", "a.gif", "a.tif"}) {
    ImageFrames frames(folder / name);
    EXPECT_FALSE(frames.film()) << name;
    EXPECT_EQ(frames.count(), 1U) << name;
    EXPECT_EQ(all(frames).size(), 1U) << name;
  }
}

TEST(ImageFrames, PagesOfOtherSizesAreNone) {
  const TempFolder folder;
  test::write_film(folder / "a.tif", {coloured(1, 0, 0, 8, 8), coloured(1, 0, 0, 4, 4)});
  ImageFrames frames(folder / "a.tif");
  EXPECT_FALSE(frames.film());
  const auto images = all(frames);
  ASSERT_EQ(images.size(), 1U);
  EXPECT_EQ(images[0].height, 8);
}

TEST(ImageFrames, WhatStandsBeforeDamageIsRead) {
  const TempFolder folder;
  test::write_film(folder / "a.gif", three());
  auto bytes = read_file(folder / "a.gif", 100000);
  bytes.resize(bytes.size() * 3 / 4);
  write_file(folder / "cut.gif", bytes);
  ImageFrames frames(folder / "cut.gif");
  EXPECT_TRUE(frames.film());
  EXPECT_TRUE(frames.next());
  EXPECT_TRUE(frames.next());
  test::expect_error([&] { frames.next(); }, {"cut.gif", "after 2 images"});
  EXPECT_FALSE(frames.next());
  bytes.resize(bytes.size() * 2 / 3);
  write_file(folder / "cut.gif", bytes);
  ImageFrames fewer(folder / "cut.gif");
  EXPECT_TRUE(fewer.next());
  test::expect_error([&] { fewer.next(); }, {"cut.gif", "after 1 images"});
  EXPECT_FALSE(fewer.next());
}

TEST(ImageFrames, ATiffAfterADamagedOneIsWhole) {
  const TempFolder folder;
  test::write_film(folder / "a.tif", three());
  auto bytes = read_file(folder / "a.tif", 100000);
  bytes.resize(bytes.size() / 2);
  write_file(folder / "cut.tif", bytes);
  {
    ImageFrames cut(folder / "cut.tif");
    EXPECT_LT(all(cut).size(), 3U);
  }
  expect_three(folder / "a.tif");
}

TEST(ImageFrames, NamesWhatItCannotRead) {
  const TempFolder folder;
  write_file(folder / "text.gif", "text");
  test::expect_error([&] { ImageFrames(folder / "text.gif"); }, {"text.gif"});
  test::expect_error([&] { ImageFrames(folder / "absent.avi"); }, {"absent.avi"});
}

}  // namespace
}  // namespace vkopple
