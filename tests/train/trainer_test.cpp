#include "train/trainer.h"
#include "train/progress.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/support/events.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_scene.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "train/atomic_file.h"
#include "train/checkpoint.h"
#include "train/formats/fit_scene.h"
#include "train/formats/scene_reader.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

constexpr size_t kLargestFile = size_t{64} << 20;

/// The depth network alone for four steps, then everything.
constexpr const char* kStaged = R"({
    "model": {"height": 32, "width": 32, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 8},
    "training": {"batch": 2, "stages": [
      {"name": "depth", "networks": ["depth"], "hypotheses": "background", "steps": 4, "learning_rate": 1e-3,
       "batch": 3},
      {"name": "all"}]},
    "rooms": {"supersample": 1}})";

Config staged() { return Config::parse(kStaged, "test"); }

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// Trains up to `steps` of `total`, as a process of its own would.
bool train(const std::filesystem::path& folder, uint64_t total, uint64_t steps, bool resume,
           const Config& config = staged(), uint64_t eval_every = 0) {
  const std::unique_ptr<std::FILE, Close> sink(std::tmpfile());
  Progress progress(sink.get(), false, total);
  TrainerOptions options{.folder = RunFolder(folder), .data = "rooms:1", .steps = total, .seed = 9};
  options.checkpoint_every = 2;
  options.eval_every = eval_every;
  Trainer trainer(test_device(), config, options, resume);
  return trainer.run(progress, [&] { return trainer.position().step >= steps; });
}

std::vector<std::byte> bytes(const std::filesystem::path& path) { return read_file(path, kLargestFile); }

std::vector<nlohmann::json> log_lines(const RunFolder& folder) {
  std::ifstream file(folder.log());
  std::vector<nlohmann::json> all;
  std::string line;
  while (std::getline(file, line)) all.push_back(nlohmann::json::parse(line));
  return all;
}

/// A run of six steps that never stopped.
class Trained : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TempFolder>();
    EXPECT_TRUE(train(straight().path(), 6, 6, false, staged(), 3));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static RunFolder straight() { return RunFolder(*folder_ / "straight"); }

  static std::unique_ptr<TempFolder> folder_;
};
std::unique_ptr<TempFolder> Trained::folder_;

TEST_F(Trained, StoppedAndResumedItWritesTheSameBytes) {
  // Within the first stage, at its end, and within the second.
  for (const uint64_t stop : {3U, 4U, 5U}) {
    const RunFolder other(*folder_ / ("stopped" + std::to_string(stop)));
    EXPECT_FALSE(train(other.path(), 6, stop, false));
    EXPECT_TRUE(train(other.path(), 6, 6, true));
    EXPECT_TRUE(bytes(other.latest()) == bytes(straight().latest())) << stop;
    EXPECT_TRUE(bytes(other.numbered(6)) == bytes(straight().numbered(6))) << stop;
  }
}

TEST(TrainerOnShards, GoesOnAtTheVerySampleWithAnyNumberOfThreads) {
  const TempFolder folder;
  Config config = Config::parse(R"({
      "model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 4},
      "training": {"batch": 2, "stages": [{"networks": ["depth"], "hypotheses": "background"}]}})",
                                "test");
  config.model.fov = std::atan(1.0);
  {
    const auto writer = create_scenes(folder / "data", "shards");
    for (int i = 0; i < 3; ++i)
      writer->add(fitted(test::small_scene(i, 5), {.height = 16, .width = 16, .fov = config.model.fov}));
    writer->finish();
  }
  const auto run = [&](const std::string& name, uint64_t steps, int threads, bool resume) {
    const std::unique_ptr<std::FILE, Close> sink(std::tmpfile());
    Progress progress(sink.get(), false, 14);
    TrainerOptions options{.folder = RunFolder(folder / name), .data = folder / "data", .steps = 14, .seed = 9};
    options.eval_every = 0;
    options.data_threads = threads;
    Trainer trainer(test_device(), config, options, resume);
    trainer.run(progress, [&] { return trainer.position().step >= steps; });
    return bytes(RunFolder(folder / name).latest());
  };
  const auto straight = run("straight", 14, 1, false);  // more than two epochs of six steps
  run("stopped", 7, 3, false);
  EXPECT_TRUE(run("stopped", 14, 2, true) == straight);
}

TEST_F(Trained, LeavesNumberedCheckpointsAndALog) {
  for (const uint64_t step : {2U, 4U, 6U})
    EXPECT_TRUE(std::filesystem::exists(straight().numbered(step))) << step;
  EXPECT_FALSE(std::filesystem::exists(straight().numbered(3)));
  EXPECT_TRUE(bytes(straight().latest()) == bytes(straight().numbered(6)));
  const auto lines = log_lines(straight());
  ASSERT_EQ(lines.size(), 6U);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(lines[i].at("step"), i + 1);
    EXPECT_EQ(lines[i].at("stage"), i < 4 ? "depth" : "all");
    EXPECT_EQ(lines[i].at("losses").contains("collapse"), i >= 4);
    EXPECT_EQ(lines[i].contains("depth_r"), i == 2 || i == 5);
  }
}

TEST_F(Trained, TellsTensorBoard) {
  const auto files = test::event_files(straight().path());
  ASSERT_EQ(files.size(), 1U);
  std::map<std::string, std::vector<int64_t>> steps;
  for (const auto& event : test::read_events(files[0]))
    for (const auto& value : event.summary().values()) steps[value.tag()].push_back(event.step());
  EXPECT_EQ(steps.at("loss/total"), (std::vector<int64_t>{4, 6}));
  EXPECT_EQ(steps.at("loss/collapse"), (std::vector<int64_t>{6}));
  EXPECT_EQ(steps.at("held_out/depth_r"), (std::vector<int64_t>{3, 6}));
  EXPECT_EQ(steps.at("held_out"), (std::vector<int64_t>{3}));
  EXPECT_EQ(steps.at("held_out/iou"), (std::vector<int64_t>{6}));  // depth was learned alone at first
}

TEST_F(Trained, KnowsItsPlace) {
  const auto middle = read_checkpoint_header(straight().numbered(4)).position;
  EXPECT_EQ(middle, (TrainingPosition{.step = 4, .stage = 0, .stage_step = 4, .seed = 9, .data = "rooms:1"}));
  const auto end = read_checkpoint_header(straight().latest()).position;
  EXPECT_EQ(end, (TrainingPosition{.step = 6, .stage = 1, .stage_step = 2, .seed = 9, .data = "rooms:1"}));
}

TEST_F(Trained, OnlyWhatLearnsChanges) {
  const SafetensorsFile before(straight().numbered(2)), middle(straight().numbered(4)),
      end(straight().latest());
  const std::map<std::string, std::string> weights{
      {"depth", "depth_model.depth_net.inc.conv.0.weight"},
      {"object", "segmentation_model.seg_net.seg_net.inc.conv.0.weight"},
      {"imagination", "imagination_model.imag_net.imag_net.inc.conv.0.weight"}};
  for (const auto& [network, name] : weights) {
    const bool from_start = network == "depth";
    EXPECT_EQ(before.read_floats(name) != middle.read_floats(name), from_start) << name;
    EXPECT_NE(middle.read_floats(name), end.read_floats(name)) << name;
    const auto m = middle.read_floats("adam/" + network + "/m/" + name);
    EXPECT_EQ(std::any_of(m.begin(), m.end(), [](float v) { return v != 0; }), from_start) << name;
  }
}

TEST_F(Trained, CountsTheCallsOfBatchNorms) {
  const SafetensorsFile end(straight().latest());
  // Four steps on one frame, two on three; two on three frames of three slots.
  EXPECT_EQ(end.read_ints("depth_model.depth_net.down1.conv.2.num_batches_tracked").at(0), 4 + 2 * 3);
  EXPECT_EQ(end.read_ints("segmentation_model.seg_net.seg_net.down1.conv.2.num_batches_tracked").at(0), 2 * 3);
  EXPECT_EQ(end.read_ints("segmentation_model.seg_net.seg_net.up0_att.conv.2.num_batches_tracked").at(0),
            2 * 9);
}

TEST(Trainer, AStageMayHaveFewerSlots) {
  const TempFolder folder;
  const Config config = Config::parse(R"({
      "model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 4},
      "training": {"batch": 2, "stages": [{"name": "one", "steps": 1, "slots": 1}, {"name": "all"}]}})",
                                      "test");
  EXPECT_FALSE(train(folder / "run", 2, 1, false, config, 1));
  const RunFolder run(folder / "run");
  EXPECT_EQ(load_model(test_device(), run.latest()).config.model.slots, 1);
  EXPECT_TRUE(train(folder / "run", 2, 2, true, config, 1));
  EXPECT_EQ(load_model(test_device(), run.latest()).config.model.slots, 3);
  // Three frames of one slot, then of three.
  EXPECT_EQ(SafetensorsFile(run.latest())
                .read_ints("segmentation_model.seg_net.seg_net.up0_att.conv.2.num_batches_tracked"),
            std::vector<std::int64_t>{3 + 9});
}

TEST_F(Trained, SeedsMatter) {
  const RunFolder other(*folder_ / "seed");
  const std::unique_ptr<std::FILE, Close> sink(std::tmpfile());
  Progress progress(sink.get(), false, 1);
  TrainerOptions options{.folder = other, .data = "rooms:1", .steps = 1, .seed = 10};
  options.eval_every = 0;
  Trainer trainer(test_device(), staged(), options, false);
  EXPECT_TRUE(trainer.run(progress, [] { return false; }));
  EXPECT_NE(log_lines(other).at(0).at("losses"), log_lines(straight()).at(0).at("losses"));
}

TEST_F(Trained, AnotherConfigurationDoesNotResume) {
  Config other = staged();
  other.training.stages[1].learning_rate = 0.5;
  expect_error([&] { train(straight().path(), 9, 9, true, other); },
               {"latest.safetensors", "training.stages[1].learning_rate", "0.0003", "0.5"});
}

TEST(Trainer, ALossThatIsNoNumberStopsAndKeepsTheCheckpoint) {
  const TempFolder folder;
  Config config = staged();
  config.training.stages.erase(config.training.stages.begin());
  config.training.stages[0].learning_rate = 1;
  config.training.stages[0].batch = 1;
  EXPECT_TRUE(train(folder.path(), 2, 2, false, config));
  // Weights that are numbers, and whose products are none.
  const RunFolder run(folder.path());
  std::map<std::string, std::string> metadata;
  std::map<std::string, StoredTensor> tensors;
  {
    const SafetensorsFile file(run.latest());
    metadata = file.metadata();
    for (const auto& name : file.names()) tensors.emplace(name, file.read(name));
  }
  for (auto& [name, tensor] : tensors)
    if (name.ends_with("outc.conv.weight") && !name.starts_with("adam/"))
      tensor = StoredTensor::of(tensor.shape, std::vector<float>(tensor.bytes.size() / 4, 3e38F));
  write_safetensors(run.latest(), metadata, tensors);
  const auto before = bytes(run.latest());
  expect_error([&] { train(folder.path(), 4, 4, true, config); }, {"step 3", "loss"});
  EXPECT_TRUE(bytes(run.latest()) == before);
  EXPECT_EQ(log_lines(run).size(), 2U);
}

TEST(Trainer, NothingIsLeftWhereTheDataAreWrong) {
  const TempFolder folder;
  const std::unique_ptr<std::FILE, Close> sink(std::tmpfile());
  Progress progress(sink.get(), false, 1);
  for (const std::string data : {"rooms:x", "/absent/shards"}) {
    Trainer trainer(test_device(), staged(), {.folder = RunFolder(folder / "run"), .data = data, .steps = 1},
                    false);
    expect_error([&] { trainer.run(progress, [] { return false; }); }, {data});
  }
  EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace vkopple
