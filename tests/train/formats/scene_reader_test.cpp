#include "train/formats/scene_reader.h"

#include <gtest/gtest.h>

#include "runtime/error.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_scene.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/formats/shard_scene.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::expect_same;
using test::small_scene;
using test::TempFolder;

void write(const std::filesystem::path& path, const std::string& format, const std::vector<SceneData>& scenes) {
  const auto writer = create_scenes(path, format);
  for (const SceneData& scene : scenes) writer->add(scene);
  writer->finish();
}

/// Formats that keep all that a scene holds.
class WholeFormats : public testing::TestWithParam<std::string> {};

TEST_P(WholeFormats, GiveBackWhatWasWritten) {
  const TempFolder folder;
  SceneData little = small_scene(3, 1);
  little.frames[0] = {.image = little.frames[0].image};
  little.shapes.clear();
  SceneData labels = small_scene(4, 2), depth = small_scene(5, 2);
  for (SceneFrame& frame : labels.frames) frame.depth = {};
  for (SceneFrame& frame : depth.frames) frame.ids = {};
  const std::vector<SceneData> scenes{small_scene(1, 4), small_scene(2, 3), little, labels, depth};
  write(folder / "set", GetParam(), scenes);
  EXPECT_EQ(detect_format(folder / "set").name, GetParam());
  const auto reader = open_scenes(folder / "set");
  for (const SceneData& expected : scenes) {
    const auto found = reader->next();
    ASSERT_TRUE(found);
    expect_same(*found, expected);
  }
  EXPECT_FALSE(reader->next());
}

TEST_P(WholeFormats, DoNotMixDataSets) {
  const TempFolder folder;
  write(folder / "set", GetParam(), {small_scene(1, 3)});
  expect_error([&] { create_scenes(folder / "set", GetParam()); }, {"set", "holds", "already"});
  write_file(folder / "file", "");
  expect_error([&] { create_scenes(folder / "file", GetParam()); }, {"file"});
}

TEST(ShardScenes, RememberTheScale) {
  const TempFolder folder;
  SceneData scaled = small_scene(1, 3);
  scaled.scale = 0.4;
  write(folder / "set", "shards", {scaled, small_scene(2, 3)});
  const auto reader = open_scenes(folder / "set");
  EXPECT_EQ(reader->next()->scale, 0.4);
  EXPECT_EQ(reader->next()->scale, 1);
}

TEST(ShardScenes, TooManyPixelsAreRefusedBeforeAllAreDecoded) {
  const TempFolder folder;
  SceneData film{.key = "a", .fov = 1};
  film.frames.push_back({.image = RgbImage(1000, 1000), .camera = CameraPose{}});
  Sample sample = shard_sample(film);
  for (int i = 1; i < 100; ++i) sample.parts[std::to_string(i) + ".png"] = {};
  ShardWriter(folder.path(), "rooms", 1).add(sample);
  expect_error([&] { open_scenes(folder.path())->next(); },
               {"a.0.png: 100 frames of 1000 x 1000 pixels are too many"});
}

TEST(SceneWriters, RefuseWhatTheirFormatCannotHold) {
  const TempFolder folder;
  SceneData narrow = small_scene(2, 3);
  narrow.fov = 1;
  expect_error(
      [&] {
        write(folder / "set", "recording", {small_scene(1, 3), narrow});
      },
      {"made: its angle of view is 1 ", "1.25", "--fov"});
  write_file(folder / "rooms-000000.tar", "");
  expect_error([&] { create_scenes(folder.path(), "shards"); }, {folder.path(), "holds shards already"});
  expect_error([&] { create_scenes(folder / "rooms-000000.tar", "shards"); }, {"holds shards already"});
  write(folder / "new.tar", "shards", {small_scene(1, 3)});
  EXPECT_TRUE(open_scenes(folder / "new.tar")->next());
}

INSTANTIATE_TEST_SUITE_P(Formats, WholeFormats, testing::Values("shards", "recording"));

TEST(SceneFormats, AreFoundByTheBuild) {
  std::string before;
  for (const SceneFormat& format : scene_formats()) {
    EXPECT_LT(before, format.name) << "by name";
    EXPECT_FALSE(format.about.empty());
    before = format.name;
  }
  EXPECT_EQ(scene_format("tum").create, nullptr);
  expect_error([] { scene_format("nap"); }, {"'nap'", "authors", "recording", "shards", "tum"});
  expect_error([] { create_scenes("/nowhere", "tum"); }, {"tum can only be read"});
}

TEST(SceneFormats, AreDetected) {
  const TempFolder folder;
  expect_error([&] { detect_format(folder / "absent"); }, {"absent", "no such file"});
  expect_error([&] { detect_format(folder.path()); }, {folder.path(), "no known format", "--format"});
  EXPECT_THROW(detect_format(folder.path()), UsageError);
  write_file(folder / "poses.json", "{}");
  EXPECT_EQ(detect_format(folder.path()).name, "recording");
  write_file(folder / "a.tar", "");
  expect_error([&] { detect_format(folder.path()); }, {"recording, shards", "--format"});
  EXPECT_THROW(detect_format(folder.path()), UsageError);
  EXPECT_EQ(detect_format(folder / "a.tar").name, "shards");
}

TEST(OpenScenes, RefusesOptionsThatTheFormatDoesNotKnow) {
  const TempFolder folder;
  write(folder / "set", "shards", {small_scene(1, 3)});
  EXPECT_THROW(open_scenes(folder / "set", "", {.settings = {{"fov", "3"}}}), UsageError);
  expect_error(
      [&] {
        open_scenes(folder / "set", "", {.settings = {{"fov", "3"}}});
      },
      {"--format-option fov=3", "shards knows none"});
  expect_error(
      [&] {
        open_scenes(folder / "set", "", {.settings = {{"scenes_per_shard", "3"}}});
      },
      {"--format-option scenes_per_shard=3"});
  expect_error(
      [&] {
        open_scenes(folder / "set", "shards", {.fields = {{"image", "x"}}});
      },
      {"--map image=x", "shards knows none"});
  expect_error(
      [&] {
        create_scenes(folder / "new", "shards", {.settings = {{"x", "3"}}});
      },
      {"x=3", "shards knows scenes_per_shard"});
}

TEST(OpenScenes, ChecksWhatComesOut) {
  const TempFolder folder;
  SceneData wrong = small_scene(1, 3);
  (*wrong.frames[1].camera)[3] = 1e7;
  write(folder / "far", "recording", {wrong});
  expect_error([&] { open_scenes(folder / "far")->next(); }, {"frame 1: the camera's pose is out of bounds"});
  write(folder / "twice", "recording", {small_scene(1, 3), small_scene(2, 3), small_scene(1, 3)});
  const auto reader = open_scenes(folder / "twice");
  EXPECT_TRUE(reader->next() && reader->next());
  expect_error([&] { reader->next(); }, {"key 001"});
}

TEST(FormatOptions, AreParsed) {
  std::map<std::string, std::string> found;
  add_assignments("a=b,c=d=e", "--map", found);
  add_assignments("f=1.5", "--map", found);
  EXPECT_EQ(found, (std::map<std::string, std::string>{{"a", "b"}, {"c", "d=e"}, {"f", "1.5"}}));
  for (const char* wrong : {"", "a", "=a", "x=", "x=1,", ",x=1"})
    expect_error([&] { add_assignments(wrong, "--map", found); }, {"--map", "NAME=VALUE"});
  expect_error([&] { add_assignments("a=2", "--map", found); }, {"--map", "'a' is given twice"});
  const FormatOptions options{.settings = {{"n", "7"}, {"x", "1.5"}, {"word", "seven"}},
                              .fields = {{"image", "f"}}};
  EXPECT_EQ(options.integer("n", 1, 9, 2), 7);
  EXPECT_EQ(options.integer("m", 1, 9, 2), 2);
  EXPECT_EQ(options.number("x", 0, 2, 0), 1.5);
  EXPECT_NEAR(options.degrees("none", 0, 360, 180), 3.14159265358979, 1e-12);
  EXPECT_EQ(options.field("image", "g"), "f");
  EXPECT_EQ(options.field("depth", "g"), "g");
  EXPECT_EQ(options.choice("word", {"seven", "eight"}, "eight"), "seven");
  EXPECT_EQ(options.text("words", "none"), "none");
  expect_error([&] { options.integer("n", 1, 6, 2); }, {"--format-option n=7", "whole number from 1 to 6"});
  expect_error([&] { options.integer("x", 1, 6, 2); }, {"x=1.5"});
  expect_error([&] { options.number("word", 1, 6, 2); }, {"word=seven"});
  expect_error([&] { options.choice("word", {"six"}, "six"); }, {"--format-option word=seven", "one of six"});
  const FormatOptions to{.settings = {{"n", "7"}}, .option = "--to-option"};
  expect_error([&] { to.number("n", 1, 6, 2); }, {"--to-option n=7"});
  expect_error([&] { to.choice("n", {"six"}, "six"); }, {"--to-option n=7"});
}

}  // namespace
}  // namespace vkopple
