#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/write_grey16.h"
#include "train/atomic_file.h"
#include "train/formats/scene_reader.h"
#include "train/formats/trajectory.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

/// A picture all of whose pixels are `grey` of 255.
void write_grey(const std::filesystem::path& path, int grey) {
  RgbImage image(4, 6);
  std::fill(image.pixels.begin(), image.pixels.end(), static_cast<float>(grey) / 255);
  write_png(path, image);
}

int grey_of(const SceneFrame& frame) { return static_cast<int>(std::lround(255 * frame.image.pixels[0])); }

/// Frames of each scene by their grey levels.
std::vector<std::vector<int>> greys(SceneReader& reader) {
  std::vector<std::vector<int>> all;
  while (const auto scene = reader.next()) {
    all.emplace_back();
    for (const SceneFrame& frame : scene->frames) all.back().push_back(grey_of(frame));
  }
  return all;
}

class RecordingTest : public testing::Test {
 protected:
  RecordingTest() {
    for (int i = 0; i < 8; ++i) write_grey(folder_ / fmt::format("{}.png", i), i);
  }

  static std::string frame(int i, const std::string& more) {
    return fmt::format(R"({{"image": "{}.png"{}}})", i, more);
  }
  void poses(const std::string& before, const std::string& frames) {
    write_file(folder_ / "poses.json", fmt::format(R"({{{}, "frames": [{}]}})", before, frames));
  }
  void refuse(std::initializer_list<std::string> parts) {
    expect_error([&] { greys(*open_scenes(folder_.path())); }, parts);
  }

  TempFolder folder_;
};

TEST_F(RecordingTest, ReadsPosesOfBothForms) {
  poses(R"("fov_degrees": 60, "axes": {"camera": "optical", "world": "z-up"})",
        frame(0, R"(, "camera": [1, 2, 3, 0.1, 0.2, 0.3])") + "," +
            frame(1, R"(, "position": [4, 5, 6], "quaternion": [0.5, -0.5, 0.5, -0.5])") + "," + frame(2, ""));
  const auto reader = open_scenes(folder_.path());
  EXPECT_EQ(reader->count(), 1U);
  const auto scene = reader->next();
  ASSERT_TRUE(scene);
  EXPECT_NEAR(scene->fov, 1.0471975511965976, 1e-12);
  ASSERT_EQ(scene->frames.size(), 3U);
  EXPECT_EQ(*scene->frames[0].camera, (CameraPose{1, 2, 3, 0.1, 0.2, 0.3}));
  EXPECT_NEAR((*scene->frames[1].camera)[3], -1.5707963267948966, 1e-12);
  EXPECT_FALSE(scene->frames[2].camera);
}

TEST_F(RecordingTest, IsCutIntoScenes) {
  std::string all;
  for (int i = 0; i < 8; ++i) all += (i > 0 ? "," : "") + frame(i, "");
  poses(R"("fov": 1)", all);
  const auto cut = [&](const std::map<std::string, std::string>& settings) {
    return greys(*open_scenes(folder_.path(), "", {.settings = settings}));
  };
  using Greys = std::vector<std::vector<int>>;
  EXPECT_EQ(cut({}), (Greys{{0, 1, 2, 3, 4, 5, 6, 7}}));
  EXPECT_EQ(cut({{"frames", "3"}}), (Greys{{0, 1, 2}, {3, 4, 5}})) << "two frames are left over";
  EXPECT_EQ(cut({{"frames", "5"}}), (Greys{{0, 1, 2, 3, 4}, {5, 6, 7}}));
  EXPECT_EQ(cut({{"frames", "3"}, {"every", "2"}}), (Greys{{0, 2, 4}}));
  EXPECT_EQ(cut({{"frames", "1"}, {"every", "4"}}), (Greys{{0}, {4}}));
  expect_error([&] { cut({{"frames", "121"}}); }, {"frames=121"});
  expect_error([&] { cut({{"every", "4"}}); }, {"poses.json", "three frames"});
  poses(R"("fov": 1)", frame(0, R"(, "scene": "a")") + "," + frame(1, R"(, "scene": "a")") + "," +
                           frame(2, R"(, "scene": "b")"));
  EXPECT_EQ(cut({{"frames", "1"}}), (Greys{{0, 1}, {2}}));
}

TEST_F(RecordingTest, NamesWhatIsWrong) {
  const std::string good = frame(0, "") + "," + frame(1, "") + ",";
  poses(R"("fov": 1)", good + R"({"image": "../secret.png"})");
  refuse({"poses.json", "frames[2].image", "'../secret.png'", "within"});
  poses(R"("fov": 1)", good + R"({"image": "/etc/secret.png"})");
  refuse({"frames[2].image", "within"});
  poses(R"("fov": 1)", good + R"({"image": "2.png", "layers": "a/../../b.exr"})");
  refuse({"frames[2].layers", "within"});
  poses(R"("fov": 1)", good + R"({"image": "absent.png"})");
  refuse({"absent.png"});
  poses(R"("fov": 1)", good + frame(2, R"(, "camera": [1, 2])"));
  refuse({"frames[2].camera"});
  poses(R"("fov": 1)", good + frame(2, R"(, "position": [1, 2, 3], "quaternion": [1, 1, 1, 1])"));
  refuse({"frames[2].quaternion", "no unit quaternion"});
  poses(R"("fov": 1)", good + frame(2, R"(, "position": [1, 2, 3])"));
  refuse({"frames[2]", "quaternion"});
  poses(R"("fov": 4)", good + frame(2, ""));
  refuse({"poses.json", "fov"});
  poses(R"("fov": 1, "axes": {"camera": "upside-down", "world": "z-up"})", good + frame(2, ""));
  refuse({"axes.camera", "body, graphics, optical, own"});
  poses(R"("fov": 1)", good + frame(2, R"(, "scene": "a")"));
  refuse({"''", "key"});
  std::string many;
  for (int i = 0; i < 121; ++i) many += (i > 0 ? "," : "") + frame(0, R"(, "scene": "long")");
  poses(R"("fov": 1)", many);
  refuse({"'long'", "121 frames", "120"});
  write_file(folder_ / "poses.json", "[");
  refuse({"poses.json"});
}

TEST_F(RecordingTest, TooManyPixelsAreRefusedBeforeAllAreDecoded) {
  write_png(folder_ / "0.png", RgbImage(1000, 1000));
  const auto film = [&](const std::string& first) {
    std::string frames = frame(0, R"(, "scene": "a")" + first);
    for (int i = 0; i < 99; ++i) frames += R"(, {"image": "absent.png", "scene": "a"})";
    return frames;
  };
  poses(R"("fov": 1)", film(""));
  refuse({"0.png: 100 frames of 1000 x 1000 pixels are too many"});
  write_grey(folder_ / "0.png", 0);
  write_depth_exr(folder_ / "0.exr", Plane<float>(1000, 1000));
  poses(R"("fov": 1)", film(R"(, "layers": "0.exr")"));
  refuse({"0.png: 100 frames of 1000 x 1000 pixels are too many"});
}

class TumTest : public testing::Test {
 protected:
  TumTest() {
    std::filesystem::create_directory(folder_ / "rgb");
    for (int i = 0; i < 6; ++i) write_grey(folder_ / "rgb" / fmt::format("{:.6f}.png", 100.5 + 0.1 * i), i);
    write_file(folder_ / "rgb" / "notes.txt", "no picture");
    std::string text = "# timestamp tx ty tz qx qy qz qw\n";
    for (int i = 0; i < 6; ++i)  // looking along x, 4 ms late
      text += fmt::format("{:.4f} {} 2 1.5 -0.5 0.5 -0.5 0.5\n", 100.504 + 0.1 * i, i);
    write_file(folder_ / "groundtruth.txt", text);
  }

  std::unique_ptr<SceneReader> open(std::map<std::string, std::string> more = {}) {
    more["fov"] = "50";
    return open_scenes(folder_.path(), "", {.settings = more});
  }

  TempFolder folder_;
};

TEST_F(TumTest, PicturesGetTheNearestPose) {
  const auto scene = open()->next();
  ASSERT_TRUE(scene);
  EXPECT_NEAR(scene->fov, 0.8726646259971648, 1e-12);
  ASSERT_EQ(scene->frames.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(grey_of(scene->frames[i]), static_cast<int>(i)) << "in the order of time";
    const CameraPose expected{static_cast<double>(i), 2, 1.5, -1.5707963267948966, 0, 0};
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR((*scene->frames[i].camera)[k], expected[k], 1e-12);
  }
  const auto graphics = open({{"camera", "graphics"}})->next();
  EXPECT_NEAR(std::abs((*graphics->frames[0].camera)[5]), 3.141592653589793, 1e-7)
      << "upside down by other axes";
}

TEST_F(TumTest, TrajectoriesAreSortedAndSearchedByTime) {
  write_file(folder_ / "t.txt", "3 0 0 0 0 0 0 1\r\n# x\n\n1,2,3,4,0.1,0.2,0.3,0.4\n2\t0 0 0  0 0 0 1");
  const auto poses = read_trajectory(folder_ / "t.txt");
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[0].time, 1);
  EXPECT_EQ(poses[0].position, (std::array<double, 3>{2, 3, 4}));
  EXPECT_EQ(poses[0].wxyz, (std::array<double, 4>{0.4, 0.1, 0.2, 0.3}));
  for (const auto& [time, nearest] : {std::pair{0., 1.}, {1.5, 1.}, {1.6, 2.}, {2., 2.}, {2.6, 3.}, {9., 3.}})
    EXPECT_EQ(nearest_pose(poses, time).time, nearest) << time;
}

TEST_F(TumTest, DepthPicturesAreReadWhereThereAreSome) {
  std::filesystem::create_directory(folder_ / "depth");
  test::write_grey16(folder_ / "depth" / "100.610000.png", 6, 4, 10000);  // two metres, for the second picture
  test::write_grey16(folder_ / "depth" / "100.593000.png", 6, 4, 5000);   // nearer in time
  test::write_grey16(folder_ / "depth" / "100.930000.png", 6, 4, 5000);   // too late for the fifth
  const auto scene = open()->next();
  ASSERT_TRUE(scene);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(scene->frames[i].depth.pixels.empty(), i != 1) << i;
  const double focal = 2 / std::tan(scene->fov / 2);
  EXPECT_NEAR(scene->frames[1].depth.pixels[0], std::sqrt(1 + (2.5 * 2.5 + 1.5 * 1.5) / (focal * focal)), 1e-6);
  EXPECT_NEAR(scene->frames[1].depth.pixels[8], std::sqrt(1 + (0.5 * 0.5 + 0.5 * 0.5) / (focal * focal)), 1e-6);
  EXPECT_NEAR(open({{"depth_factor", "1000"}})->next()->frames[1].depth.pixels[8],
              5 * scene->frames[1].depth.pixels[8], 1e-5);
  expect_error([&] { open({{"depth", "absent"}}); }, {"absent", "can't be read"});
}

TEST_F(TumTest, DepthPicturesOfOtherKindsAreRefused) {
  std::filesystem::create_directory(folder_ / "depth");
  const std::filesystem::path depth = folder_ / "depth" / "100.593000.png";
  write_png(depth, Plane<std::uint8_t>(4, 6));
  expect_error([&] { open()->next(); }, {"depth/100.593000.png", "one channel of 16 bits"});
  write_grey(depth, 100);
  expect_error([&] { open()->next(); }, {"depth/100.593000.png", "one channel of 16 bits"});
}

TEST_F(TumTest, PicturesWithoutAPoseEndAScene) {
  std::filesystem::rename(folder_ / "rgb" / "100.800000.png", folder_ / "rgb" / "100.850000.png");
  expect_error([&] { open(); },
               {"100.850000.png", "no pose within 0.02 s", "groundtruth.txt", "0.046 s", "skip"});
  using Greys = std::vector<std::vector<int>>;
  EXPECT_EQ(greys(*open({{"missing", "skip"}})), (Greys{{0, 1, 2}})) << "the two behind are too few";
  EXPECT_EQ(greys(*open({{"missing", "skip"}, {"frames", "2"}})), (Greys{{0, 1}, {4, 5}}));
  EXPECT_EQ(greys(*open({{"tolerance", "0.06"}})), (Greys{{0, 1, 2, 3, 4, 5}}));
  expect_error([&] { open({{"missing", "skip"}, {"tolerance", "0.001"}}); }, {"no stretch of three"});
}

TEST_F(TumTest, NamesWhatIsWrong) {
  expect_error([&] { open_scenes(folder_.path()); }, {"fov=DEGREES"});
  expect_error([&] { open({{"camera", "sideways"}}); }, {"camera=sideways", "optical"});
  expect_error([&] { open({{"images", "depth"}}); }, {"depth", "can't be read"});
  expect_error([&] { open({{"trajectory", "absent.txt"}}); }, {"absent.txt"});
  const auto wrong = [&](const std::string& text, std::initializer_list<std::string> parts) {
    write_file(folder_ / "groundtruth.txt", text);
    expect_error([&] { open(); }, parts);
  };
  wrong("# nothing\n", {"groundtruth.txt: no poses"});
  wrong("#\n1 2 3\n", {"line 2", "eight numbers", "'1 2 3'"});
  wrong("1 2 3 4 5 6 7 x\n", {"line 1"});
  wrong("1 2 3 4 5 6 7 nan\n", {"line 1"});
  std::filesystem::copy_file(folder_ / "rgb" / "100.500000.png", folder_ / "rgb" / "100.5.png");
  wrong("100.5 0 0 0 0 0 0 1\n", {"100.5", "the same timestamp"});
  std::filesystem::remove(folder_ / "rgb" / "100.5.png");
  wrong("100.5 0 0 0 0 0 0 0\n", {"at 100.500000 s", "no unit quaternion"});
  for (int i = 0; i < 6; ++i)
    std::filesystem::remove(folder_ / "rgb" / fmt::format("{:.6f}.png", 100.5 + 0.1 * i));
  wrong("100.5 0 0 0 0 0 0 1\n", {"rgb", "timestamp"});
}

}  // namespace
}  // namespace vkopple
