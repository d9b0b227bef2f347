#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/exchange_model.h"
#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/exchange/model_weights.h"
#include "train/exchange/torch_file.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

using test::expect_failure;
using test::expect_success;
using test::Outcome;
using test::run_vkopple;
using test::TempFolder;

constexpr size_t kLargest = size_t{16} << 20;

/// The folder of a run with a checkpoint of drawn weights.
class ExchangeCommands : public testing::Test {
 protected:
  ExchangeCommands() {
    std::filesystem::create_directory(run());
    write_model_checkpoint(latest(), weights_);
  }
  std::string file(const std::string& name) const { return folder_ / name; }
  std::string run() const { return file("run"); }
  std::string latest() const { return run() + "/latest.safetensors"; }

  TempFolder folder_;
  ModelWeights weights_ = test::drawn_weights();
};

TEST_F(ExchangeCommands, ARoundTripThroughTheCommands) {
  for (const std::string ending : {"pt", "safetensors"}) {
    SCOPED_TRACE(ending);
    const std::string out = file("model." + ending), back = file("back.safetensors");
    expect_success(run_vkopple({"export", run(), out}));
    expect_success(run_vkopple({"import", out, back}));
    const ModelWeights read = read_model_weights(back);
    for (const auto& [name, tensor] : weights_.tensors)
      EXPECT_EQ(read.tensors.at(name).bytes, tensor.bytes) << name;
  }
}

/// Of two stages: with the last, whose beginning the imported weights are at.
TEST_F(ExchangeCommands, TrainingGoesOnFromWhatWasImported) {
  write_torch(file("foreign.pt"), {}, weights_.tensors);
  std::ofstream(file("config.json")) << weights_.header.config.to_json();
  expect_success(run_vkopple(
      {"import", file("foreign.pt"), file("new/latest.safetensors"), "--config", file("config.json")}));
  const Outcome outcome =
      run_vkopple({"train", "--out", file("new"), "--data", "rooms:1", "--steps", "6", "--resume"});
  expect_success(outcome);
  const std::string said = outcome.output + outcome.errors;
  EXPECT_NE(said.find("stage all: steps 6 to 6"), std::string::npos) << said;
  EXPECT_EQ(said.find("stage depth"), std::string::npos) << said;
}

TEST_F(ExchangeCommands, TheExampleHasTheModelsShapes) {
  expect_success(
      run_vkopple({"export", latest(), file("m.onnx"), "--batch", "2", "--example", file("e.safetensors")}));
  EXPECT_GT(std::filesystem::file_size(file("m.onnx")), 10'000U);
  const SafetensorsFile example(file("e.safetensors"));
  EXPECT_EQ(example.names(), (std::vector<std::string>{"depth", "images", "location", "log_pose", "masks"}));
  EXPECT_EQ(example.shape("depth"), (StoredShape{2, 1, 16, 16}));
  EXPECT_EQ(example.shape("location"), (StoredShape{2, 2, 3}));
  const auto masks = example.read_floats("masks", {2, 3, 16, 16});
  for (size_t pixel = 0; pixel < 256; ++pixel)
    EXPECT_NEAR(masks[pixel] + masks[256 + pixel] + masks[512 + pixel], 1, 1e-5) << pixel;
  const auto images = example.read_floats("images", {2, 3, 16, 16});
  EXPECT_NE(images.front(), images.back());
}

TEST_F(ExchangeCommands, WhatIsReadIsNotOverwritten) {
  const auto before = read_file(latest(), kLargest);
  std::filesystem::create_symlink(latest(), file("soft.safetensors"));
  std::filesystem::create_hard_link(latest(), file("hard.safetensors"));
  for (const std::string& out :
       {latest(), run() + "/../run/latest.safetensors", file("soft.safetensors"), file("hard.safetensors")}) {
    SCOPED_TRACE(out);
    expect_failure(run_vkopple({"export", run(), out}), 2, {out, "name another"});
    expect_failure(run_vkopple({"export", latest(), file("m.onnx"), "--example", out}), 2,
                   {out, "name another"});
    expect_failure(run_vkopple({"import", latest(), out}), 2, {out, "name another"});
  }
  EXPECT_EQ(read_file(latest(), kLargest), before);
  EXPECT_FALSE(std::filesystem::exists(file("m.onnx")));
}

TEST_F(ExchangeCommands, WrongUse) {
  expect_failure(run_vkopple({"export", run(), file("m.bin")}), 2, {"m.bin", ".onnx"});
  expect_failure(run_vkopple({"export", run(), file("m.pt"), "--batch", "2"}), 2, {"--batch", ".onnx"});
  expect_failure(run_vkopple({"export", run(), file("m.pt"), "--example", file("e")}), 2,
                 {"--example", ".onnx"});
  expect_failure(run_vkopple({"export", run(), file("m.onnx"), "--bgr", "--example", file("e")}), 2, {"--bgr"});
  expect_failure(run_vkopple({"export", file("none"), file("m.pt")}), 1, {"none"});
  write_torch(file("foreign.pt"), {}, weights_.tensors);
  expect_failure(run_vkopple({"import", file("foreign.pt"), file("m.pt")}), 2, {"m.pt", ".safetensors"});
  expect_failure(run_vkopple({"import", file("foreign.pt"), file("m.safetensors")}), 2,
                 {"foreign.pt", "--config"});
  expect_failure(run_vkopple({"import", file("foreign.pt"), file("m.safetensors"), "--set", "model.slots=2"}),
                 2, {"--config"});
  expect_failure(run_vkopple({"import", file("foreign.pt"), file("m.safetensors"), "--config", "full"}), 1,
                 {"foreign.pt", "shape"});
  EXPECT_FALSE(std::filesystem::exists(file("m.safetensors")));
}

}  // namespace
}  // namespace vkopple
