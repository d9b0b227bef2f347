#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/file_size_limit.h"
#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::Outcome;
using test::run_vkopple;
using test::TempFolder;

constexpr size_t kLargestFile = size_t{1} << 20;

RgbImage stripes(int height, int width) {
  RgbImage image(height, width);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i % 7) / 6;
  return image;
}

class InferCommand : public testing::Test {
 protected:
  InferCommand() { test::write_tiny_model(model()); }

  std::string model() const { return folder_ / "model.safetensors"; }
  std::filesystem::path out() const { return folder_ / "out"; }
  std::string image(const std::string& name, int height = 16, int width = 16) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    write_png(folder_ / name, stripes(height, width));
    return folder_ / name;
  }
  Outcome infer(const std::vector<std::string>& images, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"infer", model(), "--out", out()};
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), images.begin(), images.end());
    return run_vkopple(words);
  }
  json said(const std::string& name) const {
    return json::parse(read_text_file(out() / (name + ".json"), kLargestFile));
  }
  std::set<std::string> written() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(out())) names.insert(entry.path().filename());
    return names;
  }

  TempFolder folder_;
};

TEST_F(InferCommand, ResultsHaveTheImagesSize) {
  const std::string path = image("room.png", 40, 23);
  expect_success(infer({path}));
  EXPECT_EQ(written(),
            (std::set<std::string>{"room.depth.exr", "room.json", "room.mask.png", "room.overlay.png"}));
  const RgbImage mask = read_rgb(out() / "room.mask.png"), overlay = read_rgb(out() / "room.overlay.png");
  const auto depth = decode_exr(read_file(out() / "room.depth.exr", kLargestFile), "depth").depth;
  for (const auto& [height, width] :
       {std::pair(mask.height, mask.width), std::pair(overlay.height, overlay.width),
        std::pair(depth.height, depth.width)}) {
    EXPECT_EQ(height, 40);
    EXPECT_EQ(width, 23);
  }
  const auto [nearest, farthest] = std::minmax_element(depth.pixels.begin(), depth.pixels.end());
  EXPECT_GT(*nearest, 0);
  EXPECT_LT(*farthest, 7.2F);
}

TEST_F(InferCommand, TheJsonTellsOfEverySlot) {
  const std::string path = image("room.png", 31, 20);
  expect_success(infer({path}));
  const json room = said("room");
  EXPECT_EQ(room.at("image"), path);
  EXPECT_EQ(room.at("height"), 31);
  EXPECT_EQ(room.at("background").at("index"), 2);
  ASSERT_EQ(room.at("objects").size(), 2U);
  const RgbImage mask = read_rgb(out() / "room.mask.png");
  const auto share_in_mask = [&](int index) {
    const auto count = std::count_if(mask.pixels.begin(), mask.pixels.begin() + 31 * 20,
                                     [&](float v) { return std::lround(255 * v) == index; });
    return static_cast<double>(count) / (31 * 20);
  };
  EXPECT_DOUBLE_EQ(room.at("background").at("share"), share_in_mask(2));
  for (int k = 0; k < 2; ++k) {
    const json& object = room.at("objects").at(static_cast<size_t>(k));
    EXPECT_EQ(object.at("slot"), k);
    EXPECT_DOUBLE_EQ(object.at("share"), share_in_mask(k));
    const double x = object.at("location").at(0), y = object.at("location").at(1);
    EXPECT_NEAR(object.at("angle"), std::atan2(x, y), 1e-12);
    EXPECT_NEAR(object.at("distance"), std::sqrt(x * x + y * y), 1e-12);
    const double bin = object.at("yaw").get<double>() / (2 * M_PI / 12);
    EXPECT_NEAR(bin, std::round(bin), 1e-9);
    EXPECT_GE(object.at("yaw_probability"), 1.0 / 12);
  }
}

TEST_F(InferCommand, NamesThatCollideAreNumbered) {
  const auto outcome = infer({image("a/room.png"), image("b/room.png"), image("room-2.png")}, {"--json"});
  expect_success(outcome);
  const json all = json::parse(outcome.output);
  ASSERT_EQ(all.size(), 3U);
  std::set<std::string> names;
  for (const json& one : all) names.insert(one.at("name"));
  EXPECT_EQ(names, (std::set<std::string>{"room", "room-2", "room-2-2"}));
  EXPECT_EQ(written().size(), 12U);
  EXPECT_EQ(said("room-2").at("image"), (folder_ / "b/room.png").string());
}

TEST_F(InferCommand, AnImageThatCannotBeReadIsNamed) {
  const std::string good = image("good.png");
  auto bytes = read_file(good, kLargestFile);
  bytes.resize(bytes.size() / 2);
  write_file(folder_ / "cut.png", bytes);
  expect_failure(infer({image("first.png"), folder_ / "cut.png", good}), 1, {"cut.png"});
  EXPECT_EQ(written().size(), 8U);
  expect_failure(infer({folder_ / "absent.png"}), 1, {"absent.png"});
  write_file(folder_ / "text.png", "text");
  expect_failure(infer({folder_ / "text.png"}), 1, {"text.png"});
}

TEST_F(InferCommand, NothingIsLeftHalfWritten) {
  const std::string path = image("room.png", 64, 64);
  {
    const test::FileSizeLimit limit(64);
    EXPECT_EQ(infer({path}).code, 1);
  }
  EXPECT_TRUE(written().empty());
}

TEST_F(InferCommand, NamesAFolderThatCannotBe) {
  write_file(out(), "a file");
  expect_failure(infer({image("room.png")}), 1, {out()});
}

TEST_F(InferCommand, AGridOfAll) {
  const std::string grid = folder_ / "grid.png";
  expect_success(infer({image("a.png"), image("b.png", 9, 50)}, {"--grid", grid}));
  EXPECT_EQ(read_rgb(grid).width, 3 * (128 + 4) + 4);
  EXPECT_EQ(read_rgb(grid).height, 2 * (128 + 4) + 4);
}

TEST_F(InferCommand, AModelOfDepthAloneSaysNothingOfObjects) {
  test::write_tiny_model(model(), 0);
  const auto outcome = infer({image("room.png")});
  expect_success(outcome);
  EXPECT_NE(outcome.errors.find("object network has not learned"), std::string::npos) << outcome.errors;
  EXPECT_TRUE(said("room").at("objects").empty());
  EXPECT_EQ(said("room").at("background").at("share"), 1.0);
  const RgbImage mask = read_rgb(out() / "room.mask.png");
  EXPECT_EQ(std::lround(255 * mask.pixels[0]), 2);
}

TEST_F(InferCommand, RefusesWrongUse) {
  expect_failure(run_vkopple({"infer", model(), image("a.png")}), 2, {"--out"});
  expect_failure(run_vkopple({"infer", model(), "--out", out()}), 2, {"image"});
}

}  // namespace
}  // namespace vkopple
