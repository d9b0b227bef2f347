#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/checkpoint.h"

namespace vkopple {
namespace {

using test::expect_failure;
using test::expect_success;
using test::run_vkopple;
using test::TempFolder;

class TrainCommand : public testing::Test {
 protected:
  TrainCommand() {
    write_file(folder_ / "config.json", R"({
        "model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 4},
        "training": {"stages": [{"networks": ["depth"], "hypotheses": "background"}]},
        "rooms": {"supersample": 1}})");
  }

  test::Outcome train(std::vector<std::string> more) const {
    more.insert(more.begin(), "train");
    return run_vkopple(more);
  }
  std::string config() const { return folder_ / "config.json"; }
  std::string out() const { return folder_ / "run"; }

  TempFolder folder_;
};

TEST_F(TrainCommand, TrainsInMixedPrecision) {
  expect_success(train({config(), "--data", "rooms:1", "--out", out(), "--steps", "1", "--batch", "2",
                        "--precision", "mixed", "--eval-every", "0"}));
  const std::string model = out() + "/latest.safetensors";
  expect_success(train({"--out", out(), "--resume", "--steps", "2", "--eval-every", "0"}));
  expect_failure(train({"--out", out(), "--resume", "--steps", "3", "--precision", "float32"}), 1,
                 {"training.precision", "mixed"});
  expect_failure(train({config(), "--data", "rooms:1", "--out", out() + "2", "--precision", "half"}), 2,
                 {"--precision", "half"});
  const auto scores = [&](const std::string& precision) {
    const auto outcome =
        run_vkopple({"eval", model, "--data", "rooms:2", "--images", "2", "--json", "--precision", precision});
    expect_success(outcome);
    return outcome.output;
  };
  EXPECT_NE(scores("mixed"), scores("float32"));
}

TEST_F(TrainCommand, TrainsAndGoesOn) {
  const auto first = train({config(), "--data", "rooms:1", "--out", out(), "--steps", "1", "--batch", "2"});
  expect_success(first);
  EXPECT_NE(first.errors.find("stage all: steps 1 to 1, batch 2"), std::string::npos) << first.errors;
  EXPECT_NE(first.errors.find("done after step 1, saved in " + out()), std::string::npos) << first.errors;
  expect_failure(train({config(), "--data", "rooms:1", "--out", out()}), 2, {out(), "--resume"});
  expect_failure(train({config(), "--out", out(), "--resume"}), 1, {"training.batch is 2 there and 20 here"});
  expect_failure(train({"--out", out(), "--resume", "--seed", "7"}), 2, {"--seed", "seed 0"});
  const auto second =
      train({"--out", out(), "--resume", "--steps", "2", "--checkpoint-every", "2", "--eval-every", "0"});
  expect_success(second);
  EXPECT_NE(second.errors.find("2/2 all  total"), std::string::npos) << second.errors;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run" / "step-000002.safetensors"));
  const auto third = train({"--out", out(), "--resume", "--steps", "2"});
  expect_success(third);
  EXPECT_NE(third.errors.find("has its 2 steps already"), std::string::npos) << third.errors;
}

TEST_F(TrainCommand, WorksOffABatchInPortions) {
  const std::vector<std::string> start{config(),       "--data", "rooms:1", "--out", out(),
                                       "--eval-every", "0",      "--steps", "1"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), start.begin(), start.end());
    return train(more);
  };
  expect_failure(with({"--batch", "4", "--accumulate", "3"}), 1,
                 {"4 triplets", "3 equal portions", "divides 4"});
  expect_failure(with({"--batch", "auto", "--accumulate", "2"}), 2, {"--batch auto", "--accumulate"});
  expect_failure(with({"--batch", "some"}), 2, {"--batch", "some"});
  expect_failure(with({"--batch", "0"}), 2, {"--batch", "0"});
  const auto first = with({"--batch", "4", "--accumulate", "2"});
  expect_success(first);
  EXPECT_NE(first.errors.find("stage all: steps 1 to 1, batch 4 in 2 portions"), std::string::npos)
      << first.errors;
  expect_failure(train({"--out", out(), "--resume", "--steps", "2", "--accumulate", "4"}), 1,
                 {"training.accumulate is 2 there and 4 here"});
  const auto second =
      train({"--out", out(), "--resume", "--steps", "2", "--eval-every", "0", "--batch", "auto"});
  expect_success(second);
  EXPECT_NE(second.errors.find("batch 4 in 2 portions"), std::string::npos) << second.errors;
}

TEST_F(TrainCommand, FindsPortionsByItself) {
  const auto outcome = train(
      {config(), "--data", "rooms:1", "--out", out(), "--eval-every", "0", "--steps", "1", "--batch", "auto"});
  expect_success(outcome);
  EXPECT_NE(outcome.errors.find("stage all: batch 20 with --accumulate 1 needs "), std::string::npos)
      << outcome.errors;
}

TEST_F(TrainCommand, GoesOnFromTheOneBeforeWhereTheLatestIsDamaged) {
  const std::vector<std::string> start{config(),  "--data",
                                       "rooms:1", "--out",
                                       out(),     "--steps",
                                       "3",       "--batch",
                                       "2",       "--checkpoint-every",
                                       "1",       "--keep",
                                       "2",       "--eval-every",
                                       "0"};
  expect_success(train(start));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run" / "step-000001.safetensors"));
  const std::filesystem::path latest = folder_ / "run" / "latest.safetensors";
  const std::string third = folder_ / "run" / "step-000003.safetensors";
  const auto whole = read_file(latest, size_t{64} << 20);
  auto bytes = whole;
  bytes[bytes.size() - 5] ^= std::byte{1};
  write_file(latest, bytes);
  write_file(third, "nonsense");
  const auto outcome =
      train({"--out", out(), "--resume", "--steps", "3", "--checkpoint-every", "1", "--quiet"});
  expect_success(outcome);
  for (const std::string part : {"latest.safetensors: tensor ", "is damaged", "step-000003.safetensors",
                                 "going on from", "step-000002.safetensors, after step 2"})
    EXPECT_NE(outcome.errors.find(part), std::string::npos) << part << " is not in: " << outcome.errors;
  EXPECT_TRUE(read_file(latest, size_t{64} << 20) == whole);
  for (const std::string name : {"latest", "step-000002", "step-000003"})
    write_file(folder_ / "run" / (name + ".safetensors"), "nonsense");
  expect_failure(train({"--out", out(), "--resume"}), 1,
                 {"no checkpoint is left to go on from", "latest.safetensors", "step-000002.safetensors"});
}

TEST_F(TrainCommand, IsQuietWhereAsked) {
  const auto outcome = train({config(), "--data", "rooms:1", "--out", out(), "--steps", "2", "--batch", "2",
                              "--eval-every", "0", "--quiet"});
  expect_success(outcome);
  EXPECT_EQ(outcome.errors, "");
  EXPECT_EQ(outcome.output, "");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run" / "latest.safetensors"));
  expect_failure(train({config(), "--data", "rooms:1", "--out", out(), "--quiet"}), 2, {"--resume"});
}

TEST_F(TrainCommand, PrintsItsLogAndItsEndAsJson) {
  const auto outcome = train({config(), "--data", "rooms:1", "--out", out(), "--steps", "2", "--batch", "2",
                              "--eval-every", "2", "--json"});
  expect_success(outcome);
  EXPECT_NE(outcome.errors.find("done after step 2"), std::string::npos) << outcome.errors;
  const std::string log = read_text_file(folder_ / "run" / "log.jsonl", size_t{1} << 20);
  ASSERT_TRUE(outcome.output.starts_with(log)) << outcome.output << "\n and log:\n" << log;
  EXPECT_NE(log.find("depth_r"), std::string::npos);
  EXPECT_EQ(
      nlohmann::json::parse(outcome.output.substr(log.size())),
      (nlohmann::json{
          {"outcome", "complete"}, {"step", 2}, {"steps", 2}, {"checkpoint", out() + "/latest.safetensors"}}));
  const auto nothing_left = train({"--out", out(), "--resume", "--steps", "2", "--quiet", "--json"});
  expect_success(nothing_left);
  EXPECT_EQ(nlohmann::json::parse(nothing_left.output).at("outcome"), "complete");
  EXPECT_EQ(nothing_left.errors, "");
}

TEST_F(TrainCommand, PrintsWhyItFailedAsJson) {
  const auto outcome =
      train({config(), "--data", folder_ / "absent", "--out", out(), "--steps", "9", "--quiet", "--json"});
  expect_failure(outcome, 1, {"absent"});
  const auto json = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(json.at("outcome"), "failed");
  EXPECT_EQ(json.at("step"), 0);
  EXPECT_EQ(json.at("steps"), 9);
  EXPECT_EQ("vkopple: " + json.at("error").get<std::string>() + "\n", outcome.errors);
  EXPECT_FALSE(json.contains("checkpoint"));
}

TEST_F(TrainCommand, SavesWhereItsOutputCannotBeWritten) {
  const auto outcome = run_vkopple({"train", config(), "--data", "rooms:1", "--out", out(), "--steps", "9",
                                    "--batch", "2", "--eval-every", "0", "--quiet", "--json"},
                                   "/dev/full");
  expect_failure(outcome, 1, {"standard output", "after step 1", out(), "--resume"});
  EXPECT_EQ(read_checkpoint_header(folder_ / "run" / "latest.safetensors").position.step, 1U);
}

TEST_F(TrainCommand, SetsValuesOfTheConfiguration) {
  const auto first = train({config(), "--data", "rooms:1", "--out", out(), "--steps", "1", "--batch", "2",
                            "--set", "model.statistics_frames=second", "--set", "model.reg=0.5"});
  expect_success(first);
  const Config saved = read_checkpoint_header(folder_ / "run" / "latest.safetensors").config;
  EXPECT_EQ(saved.model.statistics_frames, StatisticsFrames::kSecond);
  EXPECT_EQ(saved.model.reg, 0.5);
  expect_failure(train({"--out", out(), "--resume", "--set", "model.reg=1"}), 1,
                 {"model.reg is 0.5 there and 1"});
  expect_success(train({"--out", out(), "--resume", "--steps", "1", "--set", "model.reg=0.5"}));
  expect_failure(train({config(), "--data", "rooms:1", "--out", out() + "2", "--set", "model.rig=1"}), 1,
                 {"model.rig"});
}

TEST_F(TrainCommand, RefusesWhatCannotBe) {
  expect_failure(train({"--data", "rooms:1", "--out", out()}), 2, {"preset"});
  expect_failure(train({config(), "--out", out()}), 2, {"--data"});
  expect_failure(train({"smal", "--data", "rooms:1", "--out", out()}), 2, {"smal"});
  expect_failure(train({config(), "--data", "rooms:1"}), 2, {"--out"});
  expect_failure(train({config(), "--data", "rooms:x", "--out", out()}), 2, {"rooms:x"});
  expect_failure(train({config(), "--data", folder_ / "absent", "--out", out()}), 1, {"absent"});
  expect_failure(train({config(), "--data", "rooms:1", "--out", out(), "--steps", "0"}), 2, {"--steps"});
  expect_failure(train({config(), "--data", "rooms:1", "--out", out(), "--batch", "0"}), 2, {"--batch"});
  expect_failure(train({config(), "--data", "rooms:1", "--out", out(), "--max-bad-steps", "0"}), 2,
                 {"--max-bad-steps"});
  for (const std::string option :
       {"--steps", "--seed", "--checkpoint-every", "--eval-every", "--keep", "--max-bad-steps"})
    expect_failure(train({config(), "--data", "rooms:1", "--out", out(), option, "-1"}), 2, {option});
  expect_failure(train({"--out", out(), "--resume"}), 2, {out(), "latest.safetensors"});
  EXPECT_FALSE(std::filesystem::exists(out()));
}

TEST_F(TrainCommand, NamesWhatItCannotRead) {
  std::filesystem::create_directory(out());
  write_file(folder_ / "run" / "latest.safetensors", "nonsense");
  expect_failure(train({"--out", out(), "--resume"}), 1, {"latest.safetensors"});
  expect_failure(train({config(), "--data", "rooms:1", "--out", config() + "/run", "--steps", "1"}), 1,
                 {"run"});
}

}  // namespace
}  // namespace vkopple
