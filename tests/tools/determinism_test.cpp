// The same seed, device and driver give the same bytes: each command runs twice, as processes of their own.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tiny_run.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_success;
using test::remains_of;
using test::run_vkopple;
using test::TempFolder;

constexpr size_t kLargestFile = size_t{64} << 20;

/// Depth alone at first, then everything, so that every kind of op has been in a step.
constexpr const char* kConfig = R"({
    "model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 4},
    "training": {"batch": 2, "stages": [
      {"name": "depth", "networks": ["depth"], "hypotheses": "background", "steps": 20}, {"name": "all"}]},
    "rooms": {"supersample": 2}})";

class Determinism : public testing::Test {
 protected:
  Determinism() { write_file(config(), kConfig); }

  std::string config() const { return folder_ / "config.json"; }
  std::string run(const std::string& name, const std::string& steps = "50",
                  const std::string& seed = "3") const {
    const std::string out = folder_ / name;
    expect_success(
        run_vkopple({"train", config(), "--data", "rooms:1", "--out", out, "--steps", steps, "--seed", seed,
                     "--eval-every", "25", "--checkpoint-every", "10", "--keep", "0"}));
    return out;
  }
  std::string scores(const std::string& model, const std::string& data) const {
    const auto outcome = run_vkopple({"eval", model, "--data", data, "--images", "8", "--json"});
    expect_success(outcome);
    return outcome.output;
  }
  std::string rooms(const std::string& name) const {
    const std::string out = folder_ / name;
    expect_success(run_vkopple({"generate", out, "--scenes", "6", "--seed", "5", "--config", config()}));
    return out;
  }

  TempFolder folder_;
};

TEST_F(Determinism, DataFiftyStepsAndEvaluationAreTheSameBytes) {
  const std::string one_data = rooms("one data"), two_data = rooms("two data");
  int shards = 0;
  for (const auto& entry : std::filesystem::directory_iterator(one_data)) {
    if (entry.path().extension() != ".tar") continue;
    ++shards;
    EXPECT_EQ(read_file(entry.path(), kLargestFile),
              read_file(std::filesystem::path(two_data) / entry.path().filename(), kLargestFile));
  }
  EXPECT_EQ(shards, 1);

  const std::string one = run("one"), two = run("two");
  const auto left = remains_of(one);
  ASSERT_EQ(left.size(), 7U + 50U);  // checkpoints of every tenth step, the latest, the best; the log's lines
  EXPECT_TRUE(left == remains_of(two));
  const auto& line = left.at("log 50");
  const std::string evaluated = "\"iou\"";  // what is compared holds an evaluation
  const auto bytes = std::as_bytes(std::span(evaluated));
  EXPECT_NE(std::search(line.begin(), line.end(), bytes.begin(), bytes.end()), line.end());

  const std::string model = one + "/latest.safetensors";
  EXPECT_EQ(scores(model, one_data), scores(two + "/latest.safetensors", one_data));
  EXPECT_EQ(scores(model, "rooms:2"), scores(model, "rooms:2"));
  // Weights of another seed are others, so that the comparison above could fail.
  EXPECT_NE(remains_of(run("three", "10", "4")).at("step-000010.safetensors"),
            left.at("step-000010.safetensors"));
}

}  // namespace
}  // namespace vkopple
