#include "train/training_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

#include "graph/execution_plan.h"
#include "runtime/arena_blocks.h"
#include "runtime/buffer.h"
#include "runtime/byte_text.h"
#include "runtime/device.h"
#include "runtime/memory_budget.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "tests/support/threaded_peers.h"
#include "tests/support/vulkan_objects.h"
#include "train/parallel/memory_share.h"
#include "train/trainer.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::VulkanObjects;

Config config() {
  return Config::parse(R"({
      "model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 4},
      "training": {"batch": 8, "stages": [
        {"name": "depth", "networks": ["depth"], "hypotheses": "background", "steps": 2},
        {"name": "all"}]},
      "rooms": {"supersample": 1}})",
                       "test");
}

uint64_t bytes_of(const Config& config, size_t stage, int accumulate, const TrainingSetting& setting = {}) {
  TrainingStage of = config.training.stages.at(stage);
  of.accumulate = accumulate;
  return stage_bytes(test_device().caps(), config, of, setting);
}

/// Listens to what device memory this process has in each stage, at most.
class Fullest final : public TrainingListener {
 public:
  void show(const StepRecord& record) override {
    uint64_t& most = bytes[record.stage];
    most = std::max(most, VulkanObjects::now().memory_bytes - before);
  }
  void say(std::string_view) override {}

  uint64_t before = VulkanObjects::now().memory_bytes;
  std::map<std::string, uint64_t> bytes;
};

TEST(TrainingMemory, IsWhatTrainingTakes) {
  const test::TempFolder folder;
  // One that has copied nothing yet would grow its buffer for that.
  constexpr uint64_t kStaging = uint64_t{2} << 20;
  for (const bool measured : {true, false}) {
    for (const int accumulate : {1, 4}) {
      Config c = config();
      for (TrainingStage& stage : c.training.stages) stage.accumulate = accumulate;
      TrainerOptions options{.folder = RunFolder(folder / "run"), .data = "rooms:1", .steps = 4};
      options.eval_every = measured ? 1 : 0;
      Fullest fullest;
      Trainer trainer(test_device(), c, options, false);
      trainer.run(fullest, [] { return false; });
      std::filesystem::remove_all(folder / "run");
      for (size_t stage : {0U, 1U}) {
        const uint64_t planned = bytes_of(c, stage, accumulate, training_setting(options));
        const uint64_t taken = fullest.bytes.at(c.training.stages[stage].name);
        EXPECT_LE(taken, planned + kStaging) << stage << ", " << measured << ", " << accumulate;
        // A stage's groups come to be one after the other, so that blocks may end elsewhere.
        EXPECT_GE(taken + kGroupBlockBytes, planned) << stage << ", " << measured << ", " << accumulate;
      }
    }
  }
}

TEST(TrainingMemory, PortionsTakeLess) {
  const Config c = config();
  for (const size_t stage : {0U, 1U}) {
    EXPECT_LT(bytes_of(c, stage, 2), bytes_of(c, stage, 1));
    EXPECT_LT(bytes_of(c, stage, 8), bytes_of(c, stage, 2));
  }
  EXPECT_LT(bytes_of(c, 0, 1), bytes_of(c, 1, 1));
  EXPECT_LT(bytes_of(c, 1, 1, {.measured = false}), bytes_of(c, 1, 1));
  EXPECT_LT(bytes_of(c, 1, 1, {.drawn = false}), bytes_of(c, 1, 1));
}

TEST(TrainingMemory, TooLittleIsRefusedBeforeAnyIsTaken) {
  const test::TempFolder folder;
  const uint64_t whole = bytes_of(config(), 1, 1), halves = bytes_of(config(), 1, 2);
  const auto begin = [&](uint64_t free, bool resume = false) {
    TrainerOptions options{.folder = RunFolder(folder / "run"), .data = "rooms:1", .steps = 4};
    options.free_memory = free;
    return std::make_unique<Trainer>(test_device(), config(), options, resume);
  };
  const uint64_t before = VulkanObjects::now().memory_bytes;
  expect_error([&] { begin(whole - 1); },
               {"stage all needs " + byte_text(whole), byte_text(whole - 1) + " free",
                "--batch 8 --accumulate 2 needs " + byte_text(halves), "--batch auto"});
  expect_error([&] { begin(1 << 20); },
               {"stage depth needs", "--accumulate 8, a triplet at a time", "image size"});
  EXPECT_EQ(VulkanObjects::now().memory_bytes, before);
  EXPECT_EQ(folder.entries(), 0U);
  {
    const auto trainer = begin(whole);
    Fullest listener;
    trainer->run(listener, [&] { return trainer->position().step == 1; });
  }
  expect_error([&] { begin(whole - 1, true); }, {"stage all needs", "keeps its batch"});
}

/// The least that must be free for so much to be taken.
uint64_t free_for(uint64_t fitting) {
  uint64_t too_little = 0, enough = 4 * fitting + (uint64_t{1} << 32);
  while (enough - too_little > 1) {
    const uint64_t middle = (too_little + enough) / 2;
    (fitting_bytes(test_device().caps(), middle) < fitting ? too_little : enough) = middle;
  }
  return enough;
}

TEST(TrainingMemory, FittingLeavesSomethingToOthers) {
  Caps caps = test_device().caps();
  caps.type = DeviceType::kDiscrete;
  EXPECT_EQ(fitting_bytes(caps, 1000), 900U);
  caps.type = DeviceType::kCpu;
  EXPECT_EQ(fitting_bytes(caps, 1000), 0U);
  EXPECT_EQ(fitting_bytes(caps, uint64_t{10} << 30), (uint64_t{9} << 30) - (uint64_t{512} << 20));
}

TEST(TrainingMemory, FittedTrainingTakesTheFewestPortionsThatFit) {
  const Caps& caps = test_device().caps();
  Config c = config();
  auto chosen = fit_memory(caps, c, {}, uint64_t{1} << 40);
  EXPECT_EQ(c, config());
  ASSERT_EQ(chosen.size(), 2U);
  EXPECT_NE(chosen[1].find("stage all: batch 8 with --accumulate 1 needs "), std::string::npos) << chosen[1];
  for (const int portions : {2, 4, 8}) {
    c = config();
    const uint64_t free = free_for(bytes_of(c, 1, portions));
    fit_memory(caps, c, {}, free);
    EXPECT_EQ(c.training.stages[1].accumulate, portions);
    EXPECT_EQ(c.training.stages[1].batch, 8);
    EXPECT_LE(c.training.stages[0].accumulate, portions);
    if (portions == 8) break;
    fit_memory(caps, c, {}, free - 1);
    EXPECT_EQ(c.training.stages[1].accumulate, 2 * portions);
  }
  c = config();
  expect_error([&] { fit_memory(caps, c, {}, free_for(bytes_of(c, 1, 8)) - 1); },
               {"stage all needs", "--accumulate 8", "image size"});
  // Stages that the configuration does not list.
  c = config();
  c.training.stages.clear();
  fit_memory(caps, c, {}, free_for(bytes_of(config(), 1, 4)));
  EXPECT_EQ(c.training.accumulate, 4);
}

TEST(TrainingMemory, ProcessesTakeAsManyPortionsAsTheOneWithLeast) {
  const Caps& caps = test_device().caps();
  const Config c = config();
  test::run_together(2, [&](Peers& peers) {
    TrainingSetting setting{.measured = peers.rank() == 0, .peers = &peers};
    Config mine = c;
    const uint64_t two = bytes_of(c, 1, 2, setting);
    fit_memory(caps, mine, setting, peers.rank() == 0 ? uint64_t{1} << 40 : free_for(two));
    EXPECT_EQ(mine.training.stages[1].accumulate, 2);
    Caps other = caps;
    EXPECT_EQ(memory_share(1000, other, &peers), 500U);
    other.uuid[0] = static_cast<uint8_t>(other.uuid[0] + peers.rank());
    EXPECT_EQ(memory_share(1000, other, &peers), 1000U);
  });
  EXPECT_EQ(memory_share(1000, caps, nullptr), 1000U);
}

TEST(MemoryBudget, IsReadFromMeminfo) {
  std::istringstream text(
      "MemTotal:       24000000 kB\nMemFree:  5 kB\nMemAvailable:   22354896 kB\nBuffers: 3 kB\n");
  EXPECT_EQ(available_memory(text), uint64_t{22354896} * 1024);
  std::istringstream old("MemTotal:       24000000 kB\n");
  EXPECT_EQ(available_memory(old), std::nullopt);
  const uint64_t free = free_memory(test_device());
  EXPECT_GT(free, uint64_t{1} << 20);
  EXPECT_LE(free, test_device().caps().memory_bytes);
}

TEST(ByteText, HasOneDecimal) {
  EXPECT_EQ(byte_text(0), "0 bytes");
  EXPECT_EQ(byte_text(1023), "1023 bytes");
  EXPECT_EQ(byte_text(1536), "1.5 KiB");
  EXPECT_EQ(byte_text(uint64_t{3} << 29), "1.5 GiB");
  EXPECT_EQ(byte_text(uint64_t{5} << 40), "5120.0 GiB");
}

TEST(ArenaBlocks, AreThoseOfAnArena) {
  constexpr uint64_t kBlock = 4096;
  Arena arena(test_device(), MemoryKind::kDevice, "test", kBlock);
  ArenaBlocks blocks(test_device().caps(), kBlock);
  for (const uint64_t bytes : {1U, 3000U, 1000U, 5000U, 16U, 4096U, 0U}) {
    arena.allocate(bytes);
    blocks.add(bytes);
    EXPECT_EQ(blocks.total_bytes(), arena.allocated_bytes()) << bytes;
  }
  EXPECT_EQ(blocks.total_bytes(), 5 * kBlock + 5120);
}

}  // namespace
}  // namespace vkopple
