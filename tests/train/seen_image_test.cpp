#include "train/seen_image.h"

#include <gtest/gtest.h>

namespace vkopple {
namespace {

SeenImage small() {
  SeenImage seen{{2, 2}, {2, 2}, {}, 1};
  seen.mask.pixels = {0, 1, 1, 1};
  seen.depth.pixels = {1, 2, 3, 4};
  seen.objects.push_back({.location = {1, 2, 3}, .share = 0.25});
  return seen;
}

TEST(SeenImage, ResizesIndicesAndDepth) {
  const SeenImage large = resize(small(), 3, 4);
  EXPECT_EQ(large.mask.pixels, (std::vector<uint32_t>{0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(large.depth.height, 3);
  EXPECT_FLOAT_EQ(large.depth.pixels[0], 1);
  EXPECT_FLOAT_EQ(large.depth.pixels[1], 1.25F);
  EXPECT_FLOAT_EQ(large.depth.pixels[11], 4);
  EXPECT_DOUBLE_EQ(large.objects.at(0).share, 2.0 / 12);
  EXPECT_EQ(large.objects.at(0).location[2], 3);
  EXPECT_EQ(large.background, 1U);
}

TEST(SeenImage, AsJson) {
  const auto json = to_json(small());
  EXPECT_EQ(json.at("height"), 2);
  EXPECT_EQ(json.at("background").at("index"), 1);
  EXPECT_EQ(json.at("background").at("share"), 0.75);
  EXPECT_EQ(json.at("objects").at(0).at("location"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(json.at("objects").at(0).at("share"), 0.25);
}

}  // namespace
}  // namespace vkopple
