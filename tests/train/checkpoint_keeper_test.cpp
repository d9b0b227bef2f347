#include "train/checkpoint_keeper.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <vector>

#include "tests/support/expect_error.h"
#include "tests/support/faulty_files.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

using test::TempFolder;
using Steps = std::vector<uint64_t>;

class Keeper : public testing::Test {
 protected:
  CheckpointKeeper keeper(uint64_t keep, bool resumed = false, FileSystem& files = system_files()) {
    return CheckpointKeeper(folder_, keep, resumed, files, [](const auto& path, const auto& more) {
      write_safetensors(path, more, std::map<std::string, StoredTensor>{});
    });
  }
  std::string best() const { return SafetensorsFile(folder_.best()).metadata().at("score"); }

  TempFolder temporary_;
  RunFolder folder_{temporary_.path()};
};

HeldOutScores depth(double r) { return {.ari_fg = {}, .iou = {}, .depth_r = r}; }

TEST_F(Keeper, TheLastNumberedOnesStay) {
  CheckpointKeeper two = keeper(2);
  for (const uint64_t step : {5U, 10U, 15U, 20U}) two.save_numbered(step);
  EXPECT_EQ(folder_.numbered_steps(), (Steps{15, 20}));
  EXPECT_TRUE(std::filesystem::exists(folder_.latest()));
  CheckpointKeeper all = keeper(0);
  for (const uint64_t step : {25U, 30U}) all.save_numbered(step);
  EXPECT_EQ(folder_.numbered_steps(), (Steps{15, 20, 25, 30}));
}

TEST_F(Keeper, OfLaterStepsNoneIsRemoved) {
  CheckpointKeeper all = keeper(0);
  for (const uint64_t step : {10U, 20U, 30U}) all.save_numbered(step);
  CheckpointKeeper one = keeper(1, true);
  one.save_numbered(20);  // resumed from the first, as the others were damaged
  EXPECT_EQ(folder_.numbered_steps(), (Steps{20, 30}));
}

TEST_F(Keeper, NoneIsRemovedBeforeTheNewerOneIsThere) {
  bool full = false;
  CheckpointKeeper one(folder_, 1, false, system_files(), [&](const auto& path, const auto& more) {
    if (full) throw Error("the disk is full");
    write_safetensors(path, more, std::map<std::string, StoredTensor>{});
  });
  one.save_numbered(10);
  full = true;
  test::expect_error([&] { one.save_numbered(20); }, {"full"});
  EXPECT_EQ(folder_.numbered_steps(), (Steps{10}));
}

TEST_F(Keeper, WhatCannotBeRemovedStopsNothing) {
  keeper(0).save_numbered(10);
  test::FaultyFiles files(test::FaultyFiles::Fault::kFails, 0, EACCES, "unlink");
  keeper(1, false, files).save_numbered(20);
  EXPECT_TRUE(files.hit());
  EXPECT_EQ(folder_.numbered_steps(), (Steps{10, 20}));
}

TEST_F(Keeper, TheBestIsKept) {
  CheckpointKeeper first = keeper(0);
  first.save_if_best({});
  EXPECT_FALSE(std::filesystem::exists(folder_.best()));
  first.save_if_best(depth(0.5));
  EXPECT_EQ(best(), "depth_r 0.5");
  first.save_if_best(depth(0.25));
  EXPECT_EQ(best(), "depth_r 0.5");
  CheckpointKeeper resumed = keeper(0, true);
  resumed.save_if_best(depth(0.375));
  EXPECT_EQ(best(), "depth_r 0.5");
  resumed.save_if_best({.ari_fg = 0.0, .iou = 0.25, .depth_r = 0.125});
  EXPECT_EQ(best(), "iou+ari_fg 0.25");
}

TEST_F(Keeper, ADamagedBestGivesWay) {
  write_file(folder_.best(), "nonsense");
  CheckpointKeeper resumed = keeper(0, true);
  resumed.save_if_best(depth(-0.5));
  EXPECT_EQ(best(), "depth_r -0.5");
}

}  // namespace
}  // namespace vkopple
