#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "runtime/device.h"
#include "runtime/error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/threaded_peers.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"
#include "train/progress.h"
#include "train/trainer.h"

namespace vkopple {
namespace {

using test::TempFolder;

constexpr size_t kLargestFile = size_t{64} << 20;

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

Config config() {
  Config c = test::tiny_config();
  c.training.stages.clear();
  c.training.batch = 4;
  return c;
}

/// One process of a run of `total` steps that stops after `steps`; its folder would be shared.
void train(Peers& peers, const std::filesystem::path& folder, uint64_t total, uint64_t steps, bool resume) {
  const Device device;
  const std::unique_ptr<std::FILE, Close> sink(std::tmpfile());
  Progress progress(sink.get(), false, total);
  TrainerOptions options{.folder = RunFolder(folder), .data = "rooms:1", .steps = total, .seed = 9};
  options.checkpoint_every = 0;
  options.eval_every = 2;
  options.peers = &peers;
  Trainer trainer(device, config(), options, resume);
  // One of them alone is asked to stop.
  trainer.run(progress, [&] { return peers.rank() == 1 && trainer.position().step >= steps; });
  EXPECT_EQ(trainer.position().step, steps);
  EXPECT_EQ(std::ftell(sink.get()) > 0, peers.rank() == 0);
}

std::vector<std::byte> latest(const std::filesystem::path& folder) {
  return read_file(RunFolder(folder).latest(), kLargestFile);
}

TEST(SharedTrainer, StoppedAndResumedItWritesTheSameBytes) {
  const TempFolder folder;
  test::run_together(2, [&](Peers& peers) { train(peers, folder / "straight", 4, 4, false); });
  test::run_together(2, [&](Peers& peers) { train(peers, folder / "stopped", 4, 3, false); });
  EXPECT_FALSE(latest(folder / "stopped") == latest(folder / "straight"));
  test::run_together(2, [&](Peers& peers) { train(peers, folder / "stopped", 4, 4, true); });
  EXPECT_TRUE(latest(folder / "stopped") == latest(folder / "straight"));

  std::ifstream log(RunFolder(folder / "straight").log());
  int lines = 0;
  for (std::string line; std::getline(log, line); ++lines) {
    const auto json = nlohmann::json::parse(line);
    EXPECT_EQ(json.at("step"), lines + 1);
    EXPECT_EQ(json.at("processes"), 2);
    EXPECT_GT(json.at("exchange_seconds"), 0);
    EXPECT_GT(json.at("efficiency"), 0);
    EXPECT_LT(json.at("efficiency"), 1);
    EXPECT_EQ(json.contains("depth_r"), lines % 2 == 1);
  }
  EXPECT_EQ(lines, 4);
}

TEST(SharedTrainer, ProcessesMustAgree) {
  const TempFolder folder;
  test::run_together(2, [&](Peers& peers) {
    const Device device;
    TrainerOptions options{.folder = RunFolder(folder / "run"), .data = "rooms:1", .steps = 1};
    options.seed = static_cast<uint64_t>(peers.rank());
    options.peers = &peers;
    EXPECT_THROW(Trainer(device, config(), options, false), Error);
  });
  EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace vkopple
