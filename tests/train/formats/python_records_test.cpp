#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "train/formats/example.h"
#include "train/formats/scene_reader.h"

// Files that tools/reference/make_records.py wrote with the Python packages tfrecord, protobuf and Pillow.

namespace vkopple {
namespace {

std::filesystem::path fixture(const std::string& name) {
  return std::filesystem::path(VKOPPLE_SOURCE_DIR) / "tests/fixtures" / ("records-" + name + ".tfrecord");
}

/// The only scene of a fixture, whose format is recognised.
SceneData scene_of(const std::string& name) {
  EXPECT_EQ(detect_format(fixture(name)).name, name);
  const auto reader = open_scenes(fixture(name));
  const auto scene = reader->next();
  EXPECT_FALSE(reader->next());
  EXPECT_EQ(scene->key, "records-" + name + "_tfrecord-000000");
  return scene.value();
}

void expect_pose(const std::optional<CameraPose>& found, const CameraPose& expected, std::size_t frame) {
  ASSERT_TRUE(found) << "frame " << frame;
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR((*found)[i], expected[i], 1e-6) << "frame " << frame << ", number " << i;
}

void expect_colour(const RgbImage& image, std::size_t pixel, const std::array<double, 3>& expected,
                   double tolerance) {
  const std::size_t area = image.pixels.size() / 3;
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(image.pixels[c * area + pixel], expected[c] / 255, tolerance) << "channel " << c;
}

std::size_t count_of(const Plane<std::uint32_t>& ids, std::uint32_t id) {
  return static_cast<std::size_t>(std::count(ids.pixels.begin(), ids.pixels.end(), id));
}

TEST(PythonRecords, FeaturesOfEachKindAndASequence) {
  TfRecordReader reader({fixture("any")});
  const Example plain(reader.next().value());
  using namespace std::string_view_literals;
  EXPECT_EQ(plain.bytes("bytes"), (std::vector{""sv, "\0\xff"sv, "text"sv}));
  const auto floats = plain.floats("floats", 3);
  EXPECT_EQ(std::vector(floats.begin(), floats.end()), (std::vector{1.5f, -0.1f, 3e38f}));
  const auto integers = plain.integers("integers");
  EXPECT_EQ(std::vector(integers.begin(), integers.end()),
            (std::vector<std::int64_t>{0, -1, std::int64_t{1} << 62, INT64_MIN}));
  const Example sequence(reader.next().value());
  const auto places = sequence.floats("place", 6);
  EXPECT_EQ(std::vector(places.begin(), places.end()), (std::vector{0.5f, -0.25f, 1.5f, -1.25f, 2.5f, -2.25f}));
  EXPECT_EQ(sequence.bytes("name"), std::vector{"film"sv});
  EXPECT_FALSE(reader.next());
}

TEST(PythonRecords, Gqn) {
  const SceneData scene = scene_of("gqn");
  constexpr double kScale = 0.7;
  EXPECT_NEAR(scene.fov, std::numbers::pi / 4, 1e-12);
  EXPECT_EQ(scene.scale, kScale);
  ASSERT_EQ(scene.frames.size(), 3u);
  const double focal = 4 / std::tan(std::numbers::pi / 8);
  for (std::size_t i = 0; i < 3; ++i) {
    const SceneFrame& frame = scene.frames[i];
    const double yaw = 0.25 + 0.5 * static_cast<double>(i);
    expect_pose(frame.camera, {4 * std::sin(yaw) * kScale, -4 * std::cos(yaw) * kScale, kScale, yaw, 0, 0}, i);
    expect_colour(frame.image, 9, {40.0 * static_cast<double>(i) + 20, 100, 200}, 0.02);
    ASSERT_EQ(frame.depth.pixels.size(), 64u);
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        const double ray = std::sqrt(1 + std::pow((x - 3.5) / focal, 2) + std::pow((y - 3.5) / focal, 2));
        const double planar = y == 0 ? 0 : 2.0 + static_cast<double>(i);
        EXPECT_NEAR(frame.depth.pixels[static_cast<std::size_t>(8 * y + x)], kScale * planar * ray, 1e-5);
      }
    }
    EXPECT_EQ(count_of(frame.ids, 0), 56u);
    EXPECT_EQ(frame.ids.pixels[2 * 8 + 1 + i], 1u);
    EXPECT_EQ(frame.ids.pixels[3 * 8 + 2 + i], 1u);
    EXPECT_EQ(frame.ids.pixels[5 * 8 + 4], 2u);
    EXPECT_FALSE(frame.objects);
  }
}

TEST(PythonRecords, Movi) {
  const SceneData scene = scene_of("movi");
  constexpr double kScale = 0.4;
  EXPECT_NEAR(scene.fov, 0.85756, 1e-7);
  EXPECT_EQ(scene.scale, kScale);
  ASSERT_EQ(scene.frames.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const SceneFrame& frame = scene.frames[i];
    const auto step = static_cast<double>(i);
    expect_pose(frame.camera, {0.5 * step * kScale, -8 * kScale, 3 * kScale, 0, 0, 0}, i);
    expect_colour(frame.image, 63, {60, 50 * step, 250}, 1e-6);
    for (std::size_t p = 0; p < 64; ++p)
      EXPECT_NEAR(frame.depth.pixels[p], kScale * (2 + 10 * (1000 * static_cast<double>(p) + step) / 65535),
                  1e-5);
    EXPECT_EQ(count_of(frame.ids, 1), 6u);
    EXPECT_EQ(frame.ids.pixels[8 + 3 + i], 1u);
    EXPECT_EQ(count_of(frame.ids, 2), 16u);
    ASSERT_TRUE(frame.objects && frame.objects->size() == 2);
    const PlacedObject &moving = (*frame.objects)[0], &still = (*frame.objects)[1];
    const std::array<double, 3> place{(0.5 + step) * kScale, 2 * kScale, 0.25 * kScale};
    const std::array<double, 3> other{-kScale, 4 * kScale, kScale};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(moving.location[k], place[k], 1e-6);
      EXPECT_NEAR(still.location[k], other[k], 1e-6);
    }
    EXPECT_NEAR(moving.yaw.value(), 0.6, 1e-6);
    EXPECT_NEAR(still.yaw.value(), 0, 1e-6);
  }
}

TEST(PythonRecords, Clevr) {
  const SceneData scene = scene_of("clevr");
  ASSERT_EQ(scene.frames.size(), 1u);
  const SceneFrame& frame = scene.frames[0];
  ASSERT_EQ(frame.ids.height, 128);
  ASSERT_EQ(frame.ids.width, 128);
  // Rows 100 to 160 of the whole are 71 to 131 of the crop, 47 to 87 of what it is resized to.
  EXPECT_EQ(count_of(frame.ids, 1), 40u * 20);
  EXPECT_EQ(count_of(frame.ids, 2), 40u * 40);
  EXPECT_EQ(frame.ids.pixels[47 * 128 + 24], 1u);
  EXPECT_EQ(frame.ids.pixels[86 * 128 + 83], 2u);
  EXPECT_EQ(frame.ids.pixels[46 * 128 + 24], 0u);
  expect_colour(frame.image, 60 * 128 + 50, {0, 51, 255}, 1e-6);
  expect_colour(frame.image, 20 * 128 + 50, {102, 0, 0}, 1e-6);
  EXPECT_FALSE(frame.camera);
  EXPECT_TRUE(frame.depth.pixels.empty());
  EXPECT_FALSE(frame.objects);
}

}  // namespace
}  // namespace vkopple
