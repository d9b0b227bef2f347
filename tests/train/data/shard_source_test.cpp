#include "train/data/shard_source.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <span>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "train/data/read_ahead.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

const Lens kLens(4, 6, 1.0);

std::vector<std::byte> to_bytes(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// Scene `number`: every frame is one grey level, number * 10 + frame of 255; the camera's x is frame, y is
/// number.
Sample scene(int number, int frames, int height = 4, int width = 6) {
  Sample sample;
  sample.key = fmt::format("{:03}", number);
  std::string list;
  for (int frame = 0; frame < frames; ++frame) {
    RgbImage image(height, width);
    std::fill(image.pixels.begin(), image.pixels.end(), static_cast<float>(number * 10 + frame) / 255);
    sample.parts[fmt::format("{}.png", frame)] = encode_png(image);
    DepthAndIds layers{{height, width}, {height, width}};
    std::fill(layers.depth.pixels.begin(), layers.depth.pixels.end(), static_cast<float>(frame + 1));
    layers.ids.pixels[1] = 1;
    sample.parts[fmt::format("{}.exr", frame)] = encode_exr(layers);
    list += fmt::format(
        R"({}{{"camera": [{}, {}, 0.7, 0.5, 0, 0], "objects": [{{"location_in_camera": [1, 2, 3], "yaw": 2}}]}})",
        frame == 0 ? "" : ", ", frame, number);
  }
  sample.parts["json"] = to_bytes(fmt::format(R"({{"fov": 1.0, "frames": [{}]}})", list));
  return sample;
}

class ShardSourceTest : public testing::Test {
 protected:
  void write(const std::vector<Sample>& samples) {
    ShardWriter writer(folder_.path() / "set", "x", 2);
    for (const Sample& sample : samples) writer.add(sample);
    writer.finish();
  }
  ShardSource open(int batch, uint64_t seed = 1, Reading reading = Reading::kTraining,
                   const Lens& lens = kLens) {
    return ShardSource(folder_.path() / "set", lens, batch, seed, reading);
  }
  /// What reading a batch of the scene alone says is wrong with it.
  void refuse(const Sample& sample, std::initializer_list<std::string> parts, const Lens& lens = kLens) {
    const TempFolder folder;
    ShardWriter writer(folder / "set", "x", 2);
    writer.add(sample);
    writer.finish();
    expect_error([&] { ShardSource(folder / "set", lens, 1, 0, Reading::kTraining).read(0); }, parts);
  }
  TempFolder folder_;
};

/// (scene, first frame, middle frame, last frame)
using Name = std::array<int, 4>;

std::vector<Name> names(const TripletBatch& batch) {
  std::vector<Name> result;
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.batch); ++i) {
    Name name{static_cast<int>(batch.poses[0][6 * i + 1])};
    for (std::size_t k = 0; k < 3; ++k) {
      name[k + 1] = static_cast<int>(batch.poses[k][6 * i]);
      const float grey = batch.images[k][i * 72];
      EXPECT_NEAR(grey * 255, name[0] * 10 + name[k + 1], 1e-3) << "image and pose of different frames";
    }
    result.push_back(name);
  }
  return result;
}

TEST_F(ShardSourceTest, AnEpochShowsEveryStridedTripletOnce) {
  write({scene(0, 5), scene(1, 3), scene(2, 4)});  // 4 + 1 + 2 triplets
  ShardSource source = open(7);
  EXPECT_EQ(source.size(), 7U);
  const std::vector<Name> expected{{0, 0, 1, 2}, {0, 0, 2, 4}, {0, 1, 2, 3}, {0, 2, 3, 4},
                                   {1, 0, 1, 2}, {2, 0, 1, 2}, {2, 1, 2, 3}};
  const auto first = names(source.read(0)), second = names(source.read(1));
  EXPECT_NE(first, second) << "epochs are shuffled anew";
  EXPECT_EQ(names(source.read(0)), first) << "a step is the same whenever asked for";
  EXPECT_EQ(names(open(7).read(1)), second);
  EXPECT_NE(names(open(7, 2).read(0)), first);
  for (auto epoch : {first, second}) {
    std::sort(epoch.begin(), epoch.end());
    EXPECT_EQ(epoch, expected);
  }
}

TEST_F(ShardSourceTest, IncompleteBatchesAreDropped) {
  write({scene(0, 5), scene(1, 3), scene(2, 4)});
  ShardSource source = open(3);
  std::set<Name> epoch;
  for (uint64_t step = 0; step < 2; ++step) {
    for (const Name& name : names(source.read(step))) EXPECT_TRUE(epoch.insert(name).second);
  }
  EXPECT_EQ(epoch.size(), 6U);
  bool again = false;
  for (const Name& name : names(source.read(2))) again = again || epoch.contains(name);
  EXPECT_TRUE(again);
}

TEST_F(ShardSourceTest, ASmallSetRepeatsItself) {
  write({scene(0, 3)});
  EXPECT_EQ(names(open(3).read(5)), std::vector<Name>(3, Name{0, 0, 1, 2}));
}

TEST_F(ShardSourceTest, EvaluationTakesEachSceneOnceInOrder) {
  write({scene(0, 7), scene(1, 2), scene(2, 4), scene(3, 3)});
  ShardSource source = open(2, 1, Reading::kEvaluation);
  EXPECT_EQ(source.size(), 4U);
  EXPECT_EQ(names(source.read(0)), (std::vector<Name>{{0, 2, 3, 4}, {1, 0, 0, 1}}));
  EXPECT_EQ(names(source.read(1)), (std::vector<Name>{{2, 0, 1, 2}, {3, 0, 1, 2}}));
  EXPECT_EQ(names(source.read(2))[0], (Name{0, 2, 3, 4}));
  const TripletBatch batch = source.read(0);
  EXPECT_EQ(batch.depth[0], 4);
  EXPECT_EQ(batch.depth[24], 1);
  EXPECT_EQ(batch.label[1], 1U);
  EXPECT_EQ(batch.label[2], 0U);
  ASSERT_EQ(batch.objects.size(), 2U);
  EXPECT_EQ(batch.objects[1][0].location, (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(batch.objects[1][0].pixels, 1U);
  EXPECT_EQ(batch.objects[1][0].yaw, 1.5);
}

TEST_F(ShardSourceTest, OtherSizesAreResampled) {
  Sample large = scene(1, 3, 8, 12);
  RgbImage image(8, 12);
  image.pixels[0] = 1;  // a quarter of the first pixel of red
  large.parts["0.png"] = encode_png(image);
  write({large});
  const TripletBatch batch = open(1).read(0);
  EXPECT_EQ(batch.images[0].size(), 72U);
  EXPECT_NEAR(batch.images[0][0], 0.25, 1e-6);
  EXPECT_EQ(batch.depth, std::vector<float>(24, 2));
  EXPECT_EQ(batch.label.size(), 24U);
}

TEST_F(ShardSourceTest, WhatIsUnknownOfOneTripletIsMarkedAndOfAllLeftOut) {
  Sample blind = scene(1, 3);
  blind.parts.erase("1.exr");
  write({scene(0, 3), blind});
  const TripletBatch both = open(2, 1, Reading::kEvaluation).read(0);
  EXPECT_EQ(both.images[0].size(), 144U);
  const std::vector<float> depth(both.depth.begin() + 24, both.depth.end());
  const std::vector<uint32_t> label(both.label.begin() + 24, both.label.end());
  EXPECT_EQ(depth, std::vector<float>(24, 0));
  EXPECT_EQ(label, std::vector<uint32_t>(24, kUnknownLabel));
  EXPECT_GT(both.depth[0], 0);
  EXPECT_LT(both.label[0], 3U);
  ASSERT_EQ(both.objects.size(), 2U);
  EXPECT_FALSE(both.objects[0].empty());
  EXPECT_TRUE(both.objects[1].empty());
  const TripletBatch none = open(1, 1, Reading::kEvaluation).read(1);
  EXPECT_TRUE(none.depth.empty() && none.label.empty() && none.objects.empty());
}

TEST_F(ShardSourceTest, SingleImagesOfUnknownCamerasAreEvaluated) {
  Sample single = scene(1, 1);
  single.parts["json"] = to_bytes(R"({"fov": 0.5, "frames": [{}]})");
  DepthAndIds labels{{}, {4, 6}};
  labels.ids.pixels[3] = 2;
  single.parts["0.exr"] = encode_exr(labels);
  write({single});
  const TripletBatch batch = open(1, 1, Reading::kEvaluation).read(0);
  EXPECT_EQ(batch.label[3], 2U);
  EXPECT_EQ(batch.images[1], batch.images[0]);
  EXPECT_TRUE(batch.depth.empty() && batch.objects.empty() && batch.poses[1].empty());
}

TEST_F(ShardSourceTest, WhatIsShownLacksTruthAlone) {
  write({scene(0, 5), scene(1, 3)});
  ShardSource source = open(2);
  const TripletBatch whole = source.read(3), shown = source.read_shown(3);
  EXPECT_EQ(shown.images, whole.images);
  EXPECT_EQ(shown.poses, whole.poses);
  EXPECT_EQ(whole.depth.size(), 48U);
  EXPECT_TRUE(shown.depth.empty() && shown.label.empty() && shown.objects.empty());
}

TEST_F(ShardSourceTest, TheOrderIsTheSameWithAnyNumberOfThreads) {
  write({scene(0, 5), scene(1, 3), scene(2, 4)});
  ShardSource alone = open(3);
  for (const int threads : {1, 2, 7}) {
    ReadAhead several(std::make_unique<ShardSource>(folder_.path() / "set", kLens, 3, 1, Reading::kTraining),
                      threads);
    for (uint64_t step = 0; step < 12; ++step)  // six epochs
      ASSERT_EQ(names(several.read_shown(step)), names(alone.read_shown(step)))
          << threads << " threads, " << step;
    EXPECT_EQ(names(several.read_shown(5)), names(alone.read_shown(5))) << "resumed elsewhere";
  }
}

TEST_F(ShardSourceTest, RefusesWhatDoesNotFit) {
  const Sample good = scene(0, 3);
  const auto with_json = [&](const std::string& json) {
    Sample sample = good;
    sample.parts["json"] = to_bytes(json);
    return sample;
  };
  refuse(good, {"x-000000.tar: 000.json", "fov is 1 ", "1.3"}, Lens(4, 6, 1.3));
  refuse(good, {"6 x 4", "ratio of 6 x 6"}, Lens(6, 6, 1.0));
  refuse(with_json("{}"), {"000.json", "frames"});
  refuse(with_json(R"({"frames": [{"camera": [0, 0, 0, 0, 0, 0]}]})"), {"000.json", "fov"});
  refuse(with_json(R"({"fov": 1.0, "frames": []})"), {"000.json", "frames"});
  refuse(with_json(R"({"fov": 1.0, "frames": [{"camera": [1, 2]}]})"), {"000.json", "camera"});
  refuse(with_json(R"({"fov": 1.0, "frames": [{"camera": [1e300, 0, 0, 0, 0, 0]}]})"),
         {"000.json", "camera", "1000000"});
  refuse(with_json(R"({"fov": 1.0, "frames": [{}]})"), {"000.json", "frame 0 has no camera pose"});
  refuse(with_json("{"), {"000.json"});
  Sample damaged = good;
  damaged.parts["1.png"].resize(40);
  refuse(damaged, {"000.1.png"});
  damaged = good;
  damaged.parts["1.exr"].resize(40);
  refuse(damaged, {"000.1.exr"});
  damaged = good;
  damaged.parts.erase("json");
  refuse(damaged, {"000.json is missing"});
  DepthAndIds layers{{4, 6}, {4, 6}};
  layers.ids.pixels[5] = 2;
  damaged = good;
  damaged.parts["1.exr"] = encode_exr(layers);
  refuse(damaged, {"000.1.exr", "objectId 2"});
  layers.ids.pixels[5] = 4000000000;
  damaged.parts["1.exr"] = encode_exr(layers);
  refuse(damaged, {"000.1.exr", "objectId is 4000000000"});
  layers.ids.pixels[5] = 1;
  layers.depth.pixels[3] = std::numeric_limits<float>::quiet_NaN();
  damaged.parts["1.exr"] = encode_exr(layers);
  refuse(damaged, {"000.1.exr"});
  refuse(scene(0, 2), {"no scene of three frames"});
}

}  // namespace
}  // namespace vkopple
