// The same seed, device and driver give the same bytes: each command runs twice, as processes of their own.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_success;
using test::run_vkopple;
using test::TempFolder;

constexpr size_t kLargestFile = size_t{64} << 20;

/// Depth alone at first, then everything, so that every kind of op has been in a step.
constexpr const char* kConfig = R"({
    "model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 4},
    "training": {"batch": 2, "stages": [
      {"name": "depth", "networks": ["depth"], "hypotheses": "background", "steps": 20}, {"name": "all"}]},
    "rooms": {"supersample": 2}})";

/// Bytes of every file of a kind in a folder, by name.
std::map<std::string, std::vector<std::byte>> files(const std::filesystem::path& folder,
                                                    const std::string& extension) {
  std::map<std::string, std::vector<std::byte>> all;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == extension)
      all[entry.path().filename().string()] = read_file(entry.path(), kLargestFile);
  return all;
}

/// The lines of a run's log without times.
std::vector<std::string> log_lines(const std::filesystem::path& run) {
  std::istringstream text(read_text_file(run / "log.jsonl", kLargestFile));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    auto json = nlohmann::json::parse(line);
    json.erase("seconds");
    json.erase("data_seconds");
    lines.push_back(json.dump());
  }
  return lines;
}

class Determinism : public testing::Test {
 protected:
  Determinism() { write_file(config(), kConfig); }

  std::string config() const { return folder_ / "config.json"; }
  std::string run(const std::string& name, const std::string& seed = "3") const {
    const std::string out = folder_ / name;
    expect_success(run_vkopple({"train", config(), "--data", "rooms:1", "--out", out, "--steps", "50", "--seed",
                                seed, "--eval-every", "25", "--checkpoint-every", "10", "--keep", "0"}));
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
  const auto shards = files(one_data, ".tar");
  ASSERT_EQ(shards.size(), 1U);
  EXPECT_TRUE(shards == files(two_data, ".tar"));

  const std::string one = run("one"), two = run("two");
  const auto checkpoints = files(one, ".safetensors");
  ASSERT_EQ(checkpoints.size(), 7U);  // of every tenth step, the latest, the best
  const auto others = files(two, ".safetensors");
  for (const auto& [name, bytes] : checkpoints)
    EXPECT_TRUE(others.contains(name) && others.at(name) == bytes) << name;
  const auto lines = log_lines(one);
  ASSERT_EQ(lines.size(), 50U);
  EXPECT_NE(lines[49].find("\"iou\""), std::string::npos);  // what is compared holds an evaluation
  EXPECT_EQ(lines, log_lines(two));

  const std::string model = one + "/latest.safetensors";
  EXPECT_EQ(scores(model, one_data), scores(two + "/latest.safetensors", one_data));
  EXPECT_EQ(scores(model, "rooms:2"), scores(model, "rooms:2"));
  // Weights of another seed are others, so that the comparison above could fail.
  EXPECT_NE(files(run("three", "4"), ".safetensors").at("step-000010.safetensors"),
            checkpoints.at("step-000010.safetensors"));
}

}  // namespace
}  // namespace vkopple
