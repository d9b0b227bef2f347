#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"
#include "train/image_io.h"
#include "train/predictor.h"
#include "train/shards.h"

namespace vkopple {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::Outcome;
using test::run_vkopple;
using test::TempFolder;

constexpr size_t kLargestFile = size_t{1} << 20;

/// A scene of five frames as files.
class PredictCommand : public testing::Test {
 protected:
  PredictCommand() {
    test::write_tiny_model(folder_ / "model.safetensors");
    expect_success(run_vkopple({"generate", folder_ / "rooms", "--scenes", "1", "--seed", "5", "--size", "16",
                                "--frames", "5", "--config", "tiny"}));
    const auto sample = ShardReader(folder_ / "rooms").next();
    for (const auto& [extension, bytes] : sample->parts) write_file(folder_ / extension, bytes);
  }

  std::string file(const std::string& name) const { return folder_ / name; }
  Outcome predict(const std::vector<std::string>& more, const std::string& out = "out") const {
    std::vector<std::string> words{"predict", file("model.safetensors"), file("0.png"), file("1.png"), "--out",
                                   file(out)};
    words.insert(words.end(), more.begin(), more.end());
    return run_vkopple(words);
  }
  Outcome predict_with(const std::string& poses) const {
    write_file(folder_ / "poses.json", poses);
    return predict({"--poses", file("poses.json")});
  }
  json camera(size_t frame) const {
    return json::parse(read_text_file(folder_ / "json", kLargestFile)).at("frames").at(frame).at("camera");
  }

  TempFolder folder_;
};

TEST_F(PredictCommand, WritesTheThirdFrameAndItsParts) {
  const auto outcome = predict({"--poses", file("json")});
  expect_success(outcome);
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out"))
    names.insert(entry.path().filename());
  EXPECT_EQ(names, (std::set<std::string>{"comparison.png", "depth.exr", "imagined.png", "predicted.png",
                                          "warped.png", "weight.png"}));
  const RgbImage warped = read_rgb(folder_ / "out/warped.png"),
                 imagined = read_rgb(folder_ / "out/imagined.png"),
                 predicted = read_rgb(folder_ / "out/predicted.png"),
                 weight = read_rgb(folder_ / "out/weight.png");
  ASSERT_EQ(predicted.height, 16);
  for (size_t i = 0; i < predicted.pixels.size(); ++i)
    EXPECT_NEAR(predicted.pixels[i],
                weight.pixels[i] * warped.pixels[i] + (1 - weight.pixels[i]) * imagined.pixels[i], 0.01);
  EXPECT_EQ(read_rgb(folder_ / "out/comparison.png").width, 6 * (128 + 4) + 4);
  EXPECT_EQ(outcome.output.find("truth"), std::string::npos);
}

TEST_F(PredictCommand, MeasuresAgainstTheTruth) {
  const auto outcome = predict({"--poses", file("json"), "--truth", file("2.png"), "--json"});
  expect_success(outcome);
  const json errors = json::parse(outcome.output).at("mean_squared_error");
  const RgbImage truth = read_rgb(file("2.png"));
  EXPECT_NEAR(errors.at("frame_2"), mean_squared_error(read_rgb(file("1.png")), truth), 1e-9);
  EXPECT_NEAR(errors.at("predicted"), mean_squared_error(read_rgb(folder_ / "out/predicted.png"), truth), 1e-3);
  EXPECT_EQ(read_rgb(folder_ / "out/comparison.png").width, 7 * (128 + 4) + 4);
}

TEST_F(PredictCommand, PosesComeFromASceneOrAList) {
  expect_success(predict({"--poses", file("json"), "--frames", "0,2,4"}, "scene"));
  write_file(folder_ / "poses.json", json{{"poses", {camera(0), camera(2), camera(4)}}}.dump());
  expect_success(predict({"--poses", file("poses.json")}, "list"));
  expect_success(predict({"--poses", file("json")}, "others"));
  const auto bytes = [&](const std::string& out) {
    return read_file(folder_ / out / "warped.png", kLargestFile);
  };
  EXPECT_EQ(bytes("scene"), bytes("list"));
  EXPECT_NE(bytes("scene"), bytes("others"));
}

TEST_F(PredictCommand, TheCameraTurnsBeforeTheThirdFrame) {
  // To the left: what was seen moves to the right, and nothing lands on the left.
  expect_success(predict_with(R"({"poses": [[0,0,0,0,0,0], [0,0,0,0,0,0], [0,0,0,0.5,0,0]]})"));
  const RgbImage weight = read_rgb(folder_ / "out/weight.png");
  for (size_t y = 0; y < 16; ++y) {
    EXPECT_EQ(weight.pixels[16 * y], 0);
    EXPECT_GT(weight.pixels[16 * y + 10], 0.1F);
  }
}

TEST_F(PredictCommand, RefusesOtherPoses) {
  const std::string pose = "[0,0,0,0,0,0]";
  for (const std::string& poses :
       {std::string("{"), std::string("[]"), std::string("{}"), "{\"poses\": [" + pose + "," + pose + "]}",
        "{\"poses\": [" + pose + "," + pose + ",[0,0,0,0,0]]}", "{\"poses\": [" + pose + "," + pose + ",7]}",
        "{\"poses\": [" + pose + "," + pose + ",[1e300,0,0,0,0,0]]}"}) {
    SCOPED_TRACE(poses);
    expect_failure(predict_with(poses), 1, {"poses.json"});
  }
  expect_failure(predict({"--poses", file("absent.json")}), 1, {"absent.json"});
  json scene = json::parse(read_text_file(folder_ / "json", kLargestFile));
  scene["fov"] = 1.0;
  expect_failure(predict_with(scene.dump()), 1, {"poses.json", "fov"});
  expect_failure(predict({"--poses", file("json"), "--frames", "0,2,5"}), 1, {"frames"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(PredictCommand, RefusesWrongUse) {
  expect_failure(predict({}), 2, {"--poses"});
  expect_failure(predict({"--poses", file("json"), "--frames", "0,1"}), 2, {"--frames"});
  expect_failure(predict({"--poses", file("json"), "--frames", "0,1,-2"}), 2, {"--frames"});
}

TEST_F(PredictCommand, FramesHaveOneSize) {
  write_png(folder_ / "wide.png", RgbImage(16, 20));
  expect_failure(predict({"--poses", file("json"), "--truth", file("wide.png")}), 1, {"wide.png", "20 x 16"});
  expect_failure(predict({"--poses", file("json"), "--truth", file("absent.png")}), 1, {"absent.png"});
}

}  // namespace
}  // namespace vkopple
