#include "train/data/load_scenes.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/small_scene.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/data/shard_source.h"
#include "train/formats/scene_reader.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

class LoadScenesTest : public testing::Test {
 protected:
  LoadScenesTest() {
    for (const char* format : {"recording", "shards"}) {
      const auto writer = create_scenes(folder_ / format, format);
      for (int i = 0; i < 3; ++i) writer->add(test::small_scene(i, 3));
      writer->finish();
    }
  }
  TempFolder folder_;
};

TEST_F(LoadScenesTest, GivesWhatShardsOfTheSameScenesGive) {
  const Lens lens(2, 3, 1.25);
  for (const Reading reading : {Reading::kTraining, Reading::kEvaluation}) {
    ShardSource memory(load_scenes(folder_ / "recording", lens), "", lens, 2, 1, reading);
    ShardSource disk(folder_ / "shards", lens, 2, 1, reading);
    EXPECT_EQ(memory.size(), disk.size());
    for (uint64_t step = 0; step < 3; ++step) {
      const TripletBatch a = memory.read(step), b = disk.read(step);
      EXPECT_EQ(a.poses, b.poses);
      EXPECT_EQ(a.depth, b.depth);
      EXPECT_EQ(a.label, b.label);
      ASSERT_EQ(a.objects.size(), 2U);
      EXPECT_EQ(a.objects[1][0].location, b.objects[1][0].location);
      for (std::size_t i = 0; i < a.images[1].size(); ++i)  // rounded to 8 bits once made smaller
        EXPECT_NEAR(a.images[1][i], b.images[1][i], 0.502 / 255);
    }
  }
}

TEST_F(LoadScenesTest, KeepsToItsLimits) {
  const Lens lens(2, 3, 1.25);
  EXPECT_EQ(load_scenes(folder_ / "recording", lens, {.scenes = 2})->size(), 2U);
  expect_error([&] { load_scenes(folder_ / "recording", lens, {.bytes = 1000}); },
               {"recording", "too much", "vkopple convert"});
}

TEST_F(LoadScenesTest, NamesConvertWhereTheFormatNeedsOptions) {
  std::filesystem::create_directories(folder_.path() / "tum" / "rgb");
  write_file(folder_.path() / "tum" / "groundtruth.txt", "0 0 0 0 0 0 0 1\n");
  write_png(folder_.path() / "tum" / "rgb" / "0.png", RgbImage(2, 3));
  const Lens lens(2, 3, 1);
  expect_error([&] { load_scenes(folder_ / "tum", lens); }, {"fov=DEGREES", "vkopple convert"});
  write_file(folder_ / "tum" / "poses.json", "{}");
  expect_error([&] { load_scenes(folder_ / "tum", lens); }, {"recording, tum", "--format", "vkopple convert"});
  expect_error([&] { load_scenes(folder_.path(), lens); }, {"no known format", "--format", "vkopple convert"});
}

TEST_F(LoadScenesTest, ErrorsNameTheDataSet) {
  const Lens square(4, 4, 1.25);
  expect_error(
      [&] {
        ShardSource(load_scenes(folder_ / "recording", square), "", square, 1, 0, Reading::kTraining).read(0);
      },
      {"recording: 00", "6 x 4 pixels", "vkopple convert"});
}

}  // namespace
}  // namespace vkopple
