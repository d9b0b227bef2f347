#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "runtime/error.h"
#include "tests/support/expect_error.h"
#include "tests/support/fixture.h"
#include "tests/support/small_scene.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/formats/authors/authors_pictures.h"
#include "train/formats/authors/authors_table.h"
#include "train/formats/authors/authors_units.h"
#include "train/formats/scene_reader.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

using test::expect_error;
using test::small_scene;
using test::TempFolder;

constexpr double kDegree = std::numbers::pi / 180;

/// The angle of view of the small scene.
const FormatOptions kFov{.settings = {{"fov", "71.6197243913529"}}};

/// One pixel of a colour.
RgbImage pixel(float red, float green, float blue) {
  RgbImage image(1, 1);
  image.pixels = {red / 255, green / 255, blue / 255};
  return image;
}

void expect_near(const CameraPose& found, const CameraPose& expected) {
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[i], expected[i], 1e-12) << i;
}

class AuthorsTest : public testing::Test {
 protected:
  void copy_table(const std::string& name) {
    std::filesystem::copy_file(test::fixture("authors/" + name), folder_ / "data_map.pickle",
                               std::filesystem::copy_options::overwrite_existing);
  }
  /// Pictures of every frame of the fixtures' tables, at FOLDER/start.
  void write_pictures(const std::string& start) {
    std::filesystem::create_directories((folder_ / start).parent_path());
    for (const char* stem : {"r0f1", "r0f2", "r0f3", "r1f1", "r1f2", "r1f3"}) {
      const std::string name = (folder_ / (start + stem)).string();
      write_png(name + "_img.png", pixel(10, 20, 30));
      write_png(name + "_layer.png", pixel(255, 255, 0));
      write_png(name + "_id.png", pixel(0, 128, 3));
    }
  }

  TempFolder folder_;
};

TEST_F(AuthorsTest, ReadsTablesOfListsAndOfNumpy) {
  for (const char* table : {"lists.pickle", "numpy.pickle"}) {
    copy_table(table);
    write_pictures("Camera_Images/");
    const auto reader = open_scenes(folder_.path());
    EXPECT_EQ(reader->count(), 2U);
    ASSERT_TRUE(reader->next());
    const auto scene = reader->next();
    ASSERT_TRUE(scene);
    EXPECT_FALSE(reader->next());
    EXPECT_EQ(scene->shapes, (std::vector<std::string>{"Cube", "Sphere", "Cone"}));
    EXPECT_EQ(scene->fov, std::numbers::pi / 2);
    ASSERT_EQ(scene->frames.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const double number = static_cast<double>(i) + 1;
      const SceneFrame& frame = scene->frames[i];
      expect_near(*frame.camera, {1, number / 2, 0.7, -30 * number * kDegree, -2 * kDegree, 0});
      EXPECT_EQ(frame.ids.pixels[0], 3U);
      EXPECT_EQ(frame.depth.pixels[0], 3.5F);
      EXPECT_NEAR(frame.image.pixels[2], 30.0 / 255, 1e-7);
      const auto& objects = *frame.objects;
      ASSERT_EQ(objects.size(), 3U);
      EXPECT_NEAR(objects[0].location[0], (1 + number) / 10, 1e-12);
      EXPECT_NEAR(objects[0].location[1], 0.3, 1e-12);
      EXPECT_NEAR(objects[0].location[2], 0.2, 1e-12);
      EXPECT_NEAR(*objects[0].yaw, 0, 1e-12);
      EXPECT_NEAR(*objects[2].yaw, 45 * kDegree, 1e-12);
      EXPECT_NEAR(objects[2].location[1], 1, 1e-12) << "of the second row";
    }
  }
}

TEST_F(AuthorsTest, SaysHowToSaveATableOfPandas) {
  copy_table("pandas.pickle");
  expect_error([&] { open_scenes(folder_.path()); }, {"data_map.pickle", "pandas", "to_dict('list')"});
}

/// Cut off or changed anywhere, a table is read or refused in one line that begins with the file's name.
TEST_F(AuthorsTest, NamesADamagedTable) {
  const fs::path path = folder_ / "data_map.pickle";
  constexpr std::size_t kStep = 7;
  int refused = 0;
  const auto attempt = [&](const std::string& bytes) {
    fs::remove(path);  // file systems write out at once what is written over
    std::ofstream(path, std::ios::binary) << bytes;
    try {
      read_authors_table(path);
    } catch (const Error& problem) {
      const std::string text = problem.what();
      ASSERT_TRUE(text.starts_with(path.string()) && text.find('\n') == std::string::npos) << text;
      ++refused;
    }
  };
  for (const char* table : {"lists.pickle", "numpy.pickle", "pandas.pickle"}) {
    const std::string whole = read_text_file(test::fixture(std::string("authors/") + table), 1 << 20);
    const int before = refused;
    for (std::size_t i = 0; i < whole.size(); i += kStep) {
      SCOPED_TRACE(std::string(table) + " " + std::to_string(i));
      attempt(whole.substr(0, i));
      for (const int flipped : {1, 0x80}) {
        std::string changed = whole;
        changed[i] = static_cast<char>(changed[i] ^ flipped);
        attempt(changed);
      }
      if (HasFatalFailure()) return;
    }
    EXPECT_GT(refused - before, static_cast<int>(whole.size() / kStep + 1)) << table;
  }
}

TEST_F(AuthorsTest, FindsPicturesBesideTheFolderToo) {
  copy_table("lists.pickle");
  write_pictures("Camera_Images");
  EXPECT_TRUE(open_scenes(folder_.path())->next());
  const TempFolder other;
  std::filesystem::copy(folder_.path(), other / "copy");
  expect_error(
      [&] {
        open_scenes(other / "copy", "", {.settings = {{"images", "Views"}}})->next();
      },
      {"row 0", "Views/r0f1_img.png", "images="});
}

TEST_F(AuthorsTest, TruthMayBeAbsent) {
  copy_table("lists.pickle");
  write_pictures("Camera_Images/");
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "Camera_Images"))
    if (!entry.path().string().ends_with("_img.png")) std::filesystem::remove(entry.path());
  const auto scene = open_scenes(folder_.path())->next();
  ASSERT_TRUE(scene);
  EXPECT_TRUE(scene->frames[0].depth.pixels.empty() && scene->frames[0].ids.pixels.empty());
}

TEST_F(AuthorsTest, ReadsFoldersOfTexts) {
  for (int i = 0; i < 5; ++i) {
    const std::string stem = "2020-0" + std::to_string(i);
    write_file(folder_ / ("cam_pos_" + stem + ".txt"), "(10.0, 7, " + std::to_string(i) + "),\n90 0 0\n");
    write_png(folder_ / (stem + "_img.png"), pixel(1, 2, static_cast<float>(i)));
  }
  const auto reader = open_scenes(folder_.path(), "", {.settings = {{"frames", "2"}, {"fov", "60"}}});
  EXPECT_EQ(reader->count(), 2U);
  reader->next();
  const auto scene = reader->next();
  ASSERT_TRUE(scene);
  EXPECT_NEAR(scene->fov, 60 * kDegree, 1e-12);
  expect_near(*scene->frames[1].camera, {1, 0.3, 0.7, -90 * kDegree, 0, 0});
  EXPECT_NEAR(scene->frames[1].image.pixels[2], 3.0 / 255, 1e-7);
  for (const char* wrong : {"1 2 3 4 5", "1 2 3 4 5 6 7", "1 2 3 4 5 x", ""}) {
    write_file(folder_ / "cam_pos_2020-00.txt", wrong);
    expect_error([&] { open_scenes(folder_.path()); }, {"cam_pos_2020-00.txt", "six numbers"});
  }
}

TEST_F(AuthorsTest, TooManyPixelsAreRefusedBeforeAllAreDecoded) {
  for (int i = 0; i < 100; ++i) write_file(folder_ / fmt::format("cam_pos_{:02}.txt", i), "0 0 0 0 0 0");
  write_png(folder_ / "00_img.png", RgbImage(1000, 1000));
  expect_error(
      [&] {
        open_scenes(folder_.path(), "", {.settings = {{"frames", "100"}}})->next();
      },
      {"row 0: 100 frames of 1000 x 1000 pixels are too many"});
}

TEST_F(AuthorsTest, NamesWhatIsWrong) {
  const auto wrong = [&](const std::vector<AuthorsRow>& rows, std::initializer_list<std::string> parts) {
    write_file(folder_ / "data_map.pickle", authors_table_pickle(rows));
    expect_error([&] { open_scenes(folder_.path())->next(); }, parts);
  };
  const AuthorsRow row{.stems = {"a", "b", "c"}, .cameras = {CameraPose{}, CameraPose{}, CameraPose{}}};
  wrong({}, {folder_.path(), "data_map.pickle"});
  AuthorsRow climbing = row;
  climbing.stems[0] = "../a";
  wrong({climbing}, {"row 0", "'../a'"});
  wrong({row}, {"row 0", "a_img.png"});
  write_file(folder_ / "data_map.pickle", std::string("\x80\x02}.", 4));
  expect_error([&] { open_scenes(folder_.path()); }, {"data_map.pickle", "frame1"});
  write_file(folder_ / "data_map.pickle", "junk");
  expect_error([&] { open_scenes(folder_.path()); }, {"data_map.pickle"});
  expect_error([&] { labels_of_colours(pixel(255, 0, 255), "a_layer.png"); }, {"a_layer.png", "(255, 0, 255)"});
  Plane<std::uint32_t> four(1, 1);
  four.pixels[0] = 4;
  expect_error([&] { colours_of_labels(four, "scene 3"); }, {"scene 3", "at most 3 objects"});
}

TEST_F(AuthorsTest, WhatIsWrittenReadsTheSame) {
  const SceneData scene = small_scene(1, 4);
  const auto writer = create_scenes(folder_ / "set", "authors", kFov);
  writer->add(scene);
  writer->finish();
  expect_error([&] { create_scenes(folder_ / "set", "authors"); }, {"data_map.pickle already"});
  const auto reader = open_scenes(folder_ / "set", "", kFov);
  EXPECT_EQ(reader->count(), 2U);  // frames 0, 1, 2 and 1, 2, 3
  reader->next();
  const auto found = reader->next();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->fov, scene.fov, 1e-12);
  EXPECT_EQ(found->shapes, scene.shapes);
  for (std::size_t i = 0; i < 3; ++i) {
    const SceneFrame &a = found->frames[i], &b = scene.frames[i + 1];
    EXPECT_EQ(test::bytes_of(a.image), test::bytes_of(b.image));
    EXPECT_EQ(a.depth.pixels, b.depth.pixels);
    EXPECT_EQ(a.ids.pixels, b.ids.pixels);
    expect_near(*a.camera, *b.camera);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR((*a.objects)[k].location[1], (*b.objects)[k].location[1], 1e-12);
      EXPECT_NEAR(*(*a.objects)[k].yaw, *(*b.objects)[k].yaw, 1e-12);
    }
  }
}

TEST_F(AuthorsTest, TheFormatNeedsCamerasAndTriplets) {
  SceneData blind = small_scene(1, 3);
  blind.frames[1].camera.reset();
  expect_error([&] { create_scenes(folder_ / "a", "authors", kFov)->add(blind); }, {"frame 1 has no camera"});
  const auto writer = create_scenes(folder_ / "b", "authors", kFov);
  writer->add(small_scene(1, 2));
  expect_error([&] { writer->finish(); }, {"three frames"});
}

TEST_F(AuthorsTest, AnAngleOfViewThatNothingWouldTellIsRefused) {
  const SceneData scene = small_scene(1, 3);
  expect_error([&] { create_scenes(folder_ / "set", "authors")->add(scene); },
               {"made: ", "71.61972439 degrees", "90", "--fov", "--to-option fov=71.61972439"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "set" / "Camera_Images" / "001-000_img.png"));
  create_scenes(folder_ / "set", "authors", {.settings = {{"fov", "71.61972439"}}})->add(scene);
}

TEST(AuthorsPictures, DepthHasTwentyFourBits) {
  Plane<float> depth(1, 3);
  depth.pixels = {0, 4.00001F, 1e6F};
  const Plane<float> again = depth_of_colours(colours_of_depth(depth, 2), 2);
  EXPECT_EQ(again.pixels[0], 0);
  EXPECT_NEAR(again.pixels[1], 4.00001, 1e-4);
  EXPECT_NEAR(again.pixels[2], 512, 1e-3);
}

}  // namespace
}  // namespace vkopple
