#include "train/data/batch_part.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "train/data/open_source.h"
#include "train/image_io.h"
#include "train/rooms/generate.h"
#include "train/step_batch.h"

namespace vkopple {
namespace {

constexpr uint64_t kSeed = 3;
constexpr int kBatch = 4;
const Lens kLens(8, 8, 1.5);

RoomsConfig rooms() {
  RoomsConfig config;
  config.frames = 4;
  config.supersample = 1;
  return config;
}

/// Poses of what training shows in a step; they tell scenes and direction of time.
std::vector<CameraPose> shown(const std::string& data, uint64_t step, BatchPart part, BatchPart portion) {
  const auto source =
      open_triplets(test_device(), data, kLens, rooms(), kBatch / static_cast<int>(part.count * portion.count),
                    {.seed = kSeed, .part = part, .portions = portion.count});
  return training_triplets(*source, kSeed, step, kBatch, 0.5, 0, part, portion).poses;
}

/// The portions of all processes, each one's parts side by side.
void expect_parts_make_the_whole(const std::string& data, uint64_t steps) {
  const std::vector<std::pair<uint64_t, uint64_t>> counts{{2, 1}, {4, 1}, {1, 2}, {1, 4}, {2, 2}};
  for (uint64_t step = 0; step < steps; ++step) {
    const auto whole = shown(data, step, {}, {});
    ASSERT_EQ(whole.size(), 3U * kBatch);
    for (const auto& [processes, portions] : counts) {
      const size_t length = kBatch / (processes * portions);
      for (uint64_t index = 0; index < processes * portions; ++index) {
        const auto part = shown(data, step, {index % processes, processes}, {index / processes, portions});
        ASSERT_EQ(part.size(), 3 * length);
        for (size_t frame = 0; frame < 3; ++frame)
          for (size_t i = 0; i < length; ++i)
            EXPECT_EQ(part[frame * length + i], whole[frame * kBatch + index * length + i])
                << data << " step " << step << " run " << index << " of " << processes << " processes and "
                << portions << " portions";
      }
    }
  }
}

TEST(BatchPart, OfRooms) { expect_parts_make_the_whole("rooms:7", 3); }

/// Five scenes of four frames have 10 triplets: an epoch of whole batches leaves out two, which would be a
/// batch of the parts.
TEST(BatchPart, OfShardsFromEpochToEpoch) {
  const test::TempFolder folder;
  generate_rooms(test_device(),
                 {.folder = folder / "set", .scenes = 5, .seed = 1, .lens = kLens, .rooms = rooms()});
  expect_parts_make_the_whole(folder / "set", 6);
}

TEST(BatchPart, PermutationsAreOfTheWhole) {
  const auto source =
      open_triplets(test_device(), "rooms:7", kLens, rooms(), 2, {.seed = kSeed, .part = {1, 2}});
  EXPECT_EQ(training_triplets(*source, kSeed, 9, kBatch, 0.5, 0, {1, 2}).permutation,
            scene_permutation(kSeed, 9, 4));
}

}  // namespace
}  // namespace vkopple
