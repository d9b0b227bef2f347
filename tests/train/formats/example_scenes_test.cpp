#include "train/formats/example_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tfrecord.h"
#include "train/atomic_file.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::set_bytes;
using test::set_floats;

std::string text(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string png(int height = 4, int width = 4) { return text(encode_png(RgbImage(height, width))); }
std::string grey_png(std::uint8_t value) {
  Plane<std::uint8_t> plane(4, 4);
  plane.pixels.assign(16, value);
  return text(encode_png(plane));
}

const std::vector<float> kNoTurn4x4{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// One frame, as O3V's files hold it.
records::Example gqn() {
  records::Example example;
  set_bytes(example, "frames", {png()});
  set_bytes(example, "masks", {png()});
  set_floats(example, "depths", std::vector<float>(16, 1));
  set_floats(example, "camera_matrices", kNoTurn4x4);
  return example;
}

/// One frame of one instance.
records::Example movi() {
  records::Example example;
  set_bytes(example, "video", {png()});
  set_floats(example, "camera/positions", {0, 0, 0});
  set_floats(example, "camera/quaternions", {1, 0, 0, 0});
  set_floats(example, "camera/field_of_view", {1});
  set_bytes(example, "segmentations", {grey_png(1)});
  set_floats(example, "instances/positions", {1, 2, 3});
  set_floats(example, "instances/quaternions", {1, 0, 0, 0});
  return example;
}

class ExampleScenesOf : public testing::Test {
 protected:
  SceneData first(const records::Example& example, const std::string& format, const std::string& map = "",
                  const std::string& settings = "") {
    test::write_examples(folder_ / "a.tfrecord", {example});
    FormatOptions options;
    if (!map.empty()) add_assignments(map, "--map", options.fields);
    if (!settings.empty()) add_assignments(settings, "--format-option", options.settings);
    return open_scenes(folder_ / "a.tfrecord", format, options)->next().value();
  }
  void refuse(const records::Example& example, const std::string& format,
              std::initializer_list<std::string> parts, const std::string& map = "") {
    expect_error([&] { first(example, format, map); }, parts);
  }

  test::TempFolder folder_;
};

TEST_F(ExampleScenesOf, MissingFeaturesAreListedAndMapped) {
  records::Example example = gqn();
  auto& features = *example.mutable_features()->mutable_feature();
  std::swap(features["image"], features["frames"]);
  features.erase("frames");
  refuse(example, "gqn",
         {"a.tfrecord: record 0: no feature 'frames' for image", "--map image=NAME", "image (1 byte strings)",
          "camera_matrices (16 floats)"});
  EXPECT_EQ(first(example, "gqn", "image=image").frames.size(), 1u);
  expect_error([&] { first(example, "gqn", "picture=image"); }, {"--map picture=image", "image, camera"});
}

TEST_F(ExampleScenesOf, WhatIsGivenUpIsUnknown) {
  records::Example example = gqn();
  example.mutable_features()->mutable_feature()->erase("masks");
  refuse(example, "gqn", {"'masks' for mask"});
  const SceneData scene = first(example, "gqn", "mask=-,depth=-");
  EXPECT_TRUE(scene.frames[0].ids.pixels.empty());
  EXPECT_TRUE(scene.frames[0].depth.pixels.empty());
  expect_error([&] { first(example, "gqn", "mask=-,camera=-"); }, {"--map camera=-"});
  const SceneData film = first(movi(), "movi", "depth=-,depth_range=-,fov=-,mask=-,object=-");
  EXPECT_NEAR(film.fov, 0.857556, 1e-6);
  EXPECT_FALSE(film.frames[0].objects);
  EXPECT_TRUE(film.frames[0].ids.pixels.empty());
  EXPECT_TRUE(film.frames[0].depth.pixels.empty());
}

TEST_F(ExampleScenesOf, RecognisedByTheirFeaturesAlone) {
  test::write_examples(folder_ / "a.tfrecord", {gqn()}, true);
  EXPECT_EQ(detect_format(folder_.path()).name, "gqn");
  test::write_examples(folder_ / "a.tfrecord", {movi()});
  EXPECT_EQ(detect_format(folder_ / "a.tfrecord").name, "movi");
  write_file(folder_ / "a.tfrecord", "rubbish that is no file of records");
  expect_error([&] { detect_format(folder_ / "a.tfrecord"); }, {"a.tfrecord", "no known format"});
  test::write_examples(folder_ / "a.tfrecord", {records::Example()});
  expect_error([&] { detect_format(folder_ / "a.tfrecord"); }, {"no known format"});
}

TEST_F(ExampleScenesOf, ScenesFollowOneAnotherThroughAllFiles) {
  test::write_examples(folder_ / "b.tfrecord", {gqn()});
  test::write_examples(folder_ / "a.tfrecord", {gqn(), gqn()});
  const auto reader = open_scenes(folder_.path());
  std::vector<std::string> keys;
  while (const auto scene = reader->next()) keys.push_back(scene->key);
  EXPECT_EQ(keys, (std::vector<std::string>{"a_tfrecord-000000", "a_tfrecord-000001", "b_tfrecord-000000"}));
}

TEST_F(ExampleScenesOf, KeysOfLongNamesKeepTheirEnds) {
  const std::string start(70, 'x');
  for (const char* end : {".tfrecord-0-of-2", ".tfrecord-1-of-2"})
    test::write_examples(folder_ / (start + end), {gqn()});
  const auto reader = open_scenes(folder_.path());
  const std::string kept(64 - 16, 'x');
  EXPECT_EQ(reader->next().value().key, kept + "_tfrecord-0-of-2-000000");
  EXPECT_EQ(reader->next().value().key, kept + "_tfrecord-1-of-2-000000");
}

TEST_F(ExampleScenesOf, GqnRefusesWhatDoesNotFit) {
  records::Example example = gqn();
  set_floats(example, "depths", std::vector<float>(15, 1));
  refuse(example, "gqn", {"record 0: depths has 15 values, not 16"});
  example = gqn();
  set_bytes(example, "masks", {});
  refuse(example, "gqn", {"record 0: masks has 0 values, not 1"});
  example = gqn();
  set_floats(example, "camera_matrices", std::vector<float>(16, 1));
  refuse(example, "gqn", {"record 0: camera_matrices[0]", "no rotation"});
  example = gqn();
  set_bytes(example, "frames", {png().substr(0, 40)});
  refuse(example, "gqn", {"frames[0]"});
  example = gqn();
  set_bytes(example, "frames", std::vector<std::string>(121, png()));
  refuse(example, "gqn", {"record 0: frames", "121 frames"});
  set_bytes(example, "frames", {png(), png(4, 5)});
  refuse(example, "gqn", {"record 0: frames[1]", "not as large as the first frame"});
  example = gqn();
  set_bytes(example, "masks", {png(5, 4)});
  refuse(example, "gqn", {"record 0: masks[0]", "not as large as the first frame"});
  example = gqn();
  set_bytes(example, "frames", {});
  refuse(example, "gqn", {"record 0", "no frames"}, "mask=-,depth=-");
  example = gqn();
  set_floats(example, "depths", std::vector<float>(16, -1));
  refuse(example, "gqn", {"record 0", "negative"});
}

TEST_F(ExampleScenesOf, GqnRefusesMasksOfBlendedColours) {
  RgbImage many(8, 10);
  for (std::size_t i = 0; i < many.pixels.size(); ++i) many.pixels[i] = static_cast<float>(i + 1) / 255;
  records::Example example = gqn();
  set_bytes(example, "frames", {png(8, 10)});
  set_bytes(example, "masks", {text(encode_png(many))});
  refuse(example, "gqn", {"masks[0]", "more than 64 colours"}, "depth=-");
}

TEST_F(ExampleScenesOf, GqnTakesScaleAndAngleFromOptions) {
  records::Example example = gqn();
  std::vector<float> camera = kNoTurn4x4;
  camera[3] = 2, camera[7] = 1, camera[11] = 3;
  set_floats(example, "camera_matrices", camera);
  const SceneData scene = first(example, "gqn", "", "scale=2,fov=90");
  EXPECT_NEAR(scene.fov, 1.5707963, 1e-6);
  const CameraPose expected{4, -6, 2, 0, 0, 0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR((*scene.frames[0].camera)[i], expected[i], 1e-6);
  EXPECT_NEAR(scene.frames[0].depth.pixels[0], 2 * std::sqrt(1 + 2 * 0.75 * 0.75), 1e-5);
}

TEST_F(ExampleScenesOf, TooManyPixelsAreRefusedBeforeAllAreDecoded) {
  records::Example example = gqn();
  set_bytes(example, "frames", std::vector<std::string>(100, png(1000, 1000)));
  refuse(example, "gqn", {"frames[0]", "100 frames of 1000 x 1000 pixels are too many"});
}

TEST_F(ExampleScenesOf, MoviRefusesWhatDoesNotFit) {
  const std::string no_depth = "depth=-,depth_range=-";
  EXPECT_EQ(first(movi(), "movi", no_depth).frames[0].ids.pixels[0], 1u);
  records::Example example = movi();
  set_floats(example, "camera/quaternions", {0, 0, 0, 0});
  refuse(example, "movi", {"record 0: camera/quaternions[0]", "unit quaternion"}, no_depth);
  example = movi();
  set_floats(example, "instances/positions", {1, 2, 3, 4});
  refuse(example, "movi", {"instances/positions has 4 values"}, no_depth);
  example = movi();
  set_floats(example, "instances/quaternions", {1, 0, 0, 0, 1, 0, 0, 0});
  refuse(example, "movi", {"instances/quaternions has 8 values, not 4"}, no_depth);
  example = movi();
  set_bytes(example, "segmentations", {grey_png(2)});
  refuse(example, "movi", {"label 2 has no object"}, no_depth);
  example = movi();
  set_bytes(example, "segmentations", {png()});
  refuse(example, "movi", {"segmentations[0]", "one channel of 8 bits"}, no_depth);
  example = movi();
  set_floats(example, "metadata/depth_range", {1, 2});
  set_bytes(example, "depth", {grey_png(1)});
  refuse(example, "movi", {"depth[0]", "one channel of 16 bits"});
}

TEST_F(ExampleScenesOf, ClevrTakesOneStringOrManyAndRefusesOtherSizes) {
  records::Example example;
  std::string masks(std::size_t{11} * 240 * 320, '\0');
  masks[3 * 240 * 320 + 125 * 320 + 160] = 1;  // the crop's middle
  set_bytes(example, "image", {std::string(std::size_t{3} * 240 * 320, '\x33')});
  set_bytes(example, "mask", {masks});
  const SceneData scene = first(example, "clevr");
  EXPECT_NEAR(scene.frames[0].image.pixels[5], 0.2, 1e-6);
  EXPECT_EQ(scene.frames[0].ids.pixels[64 * 128 + 64], 3u);
  EXPECT_EQ(scene.frames[0].ids.pixels[0], 0u);
  set_bytes(example, "mask", {masks, "x"});
  refuse(example, "clevr", {"record 0: mask has more bytes than 844800"});
  set_bytes(example, "mask", {masks.substr(1)});
  refuse(example, "clevr", {"record 0: mask has 844799 values, not 844800"});
}

}  // namespace
}  // namespace vkopple
