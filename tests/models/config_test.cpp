#include "models/config.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>

#include "models/presets.h"
#include "models/strict_json.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

/// The message with which a configuration is refused; fails where it is accepted.
std::string refusal(const std::string& json) {
  try {
    Config::parse(json, "run.json");
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "accepted: " << json;
  return {};
}

TEST(Config, DefaultsAreThePublishedModel) {
  const Config c = Config::parse("{}", "run.json");
  EXPECT_EQ(c, Config{});
  EXPECT_EQ(c, Config::load("full"));
  EXPECT_EQ(c.model.height, 128);
  EXPECT_EQ(c.model.dropout[2], 0.0005);
  EXPECT_EQ(c.training.clip.depth, 2.5);
  EXPECT_EQ(c.rooms.shapes.size(), kRoomShapeNames.size());
}

TEST(Config, EveryPresetRoundTripsExactly) {
  EXPECT_EQ(preset_names(),
            (std::vector<std::string_view>{"full", "more-terms", "no-regularisers", "no-warp", "relaxed",
                                           "rooms-small", "rotation-3d", "small", "tiny"}));
  for (const std::string_view name : preset_names()) {
    const Config c = Config::load(std::string(name));
    EXPECT_EQ(Config::parse(c.to_json(), "again"), c) << c.to_json();
    EXPECT_EQ(Config::parse(c.to_json(), "again").to_json(), c.to_json());
  }
}

TEST(Config, StatisticsOfTheSecondFrameAloneAreAChoice) {
  EXPECT_EQ(Config::load("full").model.statistics_frames, StatisticsFrames::kAll);
  for (const char* preset : {"small", "tiny"})
    EXPECT_EQ(Config::load(preset).model.statistics_frames, StatisticsFrames::kSecond) << preset;
}

// docs/results.md: depth, then objects.
TEST(Config, TheRecipeOfRoomsTakesAtMostAMillionTriplets) {
  const Config c = Config::load("rooms-small");
  ASSERT_EQ(c.stages().size(), 2U);
  int64_t triplets = 0;
  for (const TrainingStage& stage : c.stages()) triplets += stage.steps.value() * stage.batch;
  EXPECT_LE(triplets, 1'000'000);
  EXPECT_EQ(c.stages()[1].rooms, c.rooms);  // those in which `eval` scores it
}

TEST(Config, UnroundNumbersRoundTrip) {
  Config c;
  c.model.fov = 0.1 + 0.2;
  c.training.learning_rate = 1.0 / 3;
  c.training.epsilon = 1e-7 / 3;
  c.rooms.size = {0.1 / 3, 2.0 / 3};
  c.rooms.size[0] += 0.1;
  EXPECT_EQ(Config::parse(c.to_json(), "again"), c);
}

TEST(Config, PrecisionIsWrittenWhereItIsNotTheDefault) {
  Config c;
  EXPECT_EQ(c.to_json().find("precision"), std::string::npos);
  c.training.precision = Precision::kMixed;
  EXPECT_EQ(Config::parse(c.to_json(), "again"), c);
  EXPECT_EQ(Config::parse(R"({"training": {"precision": "float32"}})", "run.json"), Config{});
  EXPECT_NE(refusal(R"({"training": {"precision": "half"}})").find("training.precision"), std::string::npos);
}

TEST(Config, SharedStatisticsAreWrittenWhereTheyAreWanted) {
  Config c;
  EXPECT_EQ(c.to_json().find("sync_batch_norm"), std::string::npos);
  c.training.sync_batch_norm = true;
  EXPECT_EQ(Config::parse(c.to_json(), "again"), c);
  EXPECT_NE(refusal(R"({"training": {"sync_batch_norm": 1}})").find("training.sync_batch_norm"),
            std::string::npos);
}

TEST(Config, PortionsAreWrittenWhereThereAreSeveral) {
  Config c = Config::load("small");
  EXPECT_EQ(c.to_json().find("accumulate"), std::string::npos);
  c.training.stages[1].accumulate = 4;
  EXPECT_EQ(Config::parse(c.to_json(), "again"), c);
  c.training.accumulate = 2;  // the first stage says that it has one
  EXPECT_EQ(Config::parse(c.to_json(), "again"), c);
  const Config inherited = Config::parse(R"({"training": {"accumulate": 2}})", "run.json");
  EXPECT_EQ(inherited.stages().front().accumulate, 2);
  EXPECT_EQ(Config::parse(R"({"training": {"accumulate": 2, "stages": [{"name": "a"}]}})", "run.json")
                .stages()
                .front()
                .accumulate,
            2);
  EXPECT_NE(refusal(R"({"training": {"accumulate": 0}})").find("training.accumulate"), std::string::npos);
}

TEST(Config, SmallLearnsDepthFirst) {
  const Config c = Config::load("small");
  ASSERT_EQ(c.stages().size(), 2U);
  const TrainingStage depth = c.stages()[0];
  EXPECT_EQ(depth.networks, std::vector<Network>{Network::kDepth});
  EXPECT_FALSE(depth.learns(Network::kObject));
  EXPECT_EQ(depth.hypotheses, Hypotheses::kBackground);
  EXPECT_EQ(depth.steps, 2500);
  EXPECT_EQ(depth.batch, 16);
  EXPECT_EQ(depth.rooms.speed, 0.2);
  EXPECT_EQ(depth.rooms.objects, c.rooms.objects);
  EXPECT_FALSE(c.stages()[1].steps);
  EXPECT_EQ(c.stages()[1].rooms, c.rooms);
  EXPECT_EQ(c.stages()[1].learning_rate, c.training.learning_rate);
}

TEST(Config, VariantsAreSmallButForTheirValues) {
  const Config small = Config::load("small");
  const auto expect = [&](const std::string& preset, const std::function<void(Config&)>& change) {
    Config expected = small;
    change(expected);
    EXPECT_EQ(Config::load(preset), expected) << Config::load(preset).to_json();
  };
  expect("no-regularisers", [](Config& c) { c.model.reg = 0; });
  expect("rotation-3d", [](Config& c) { c.model.orientation = Orientation::kEuler; });
  expect("relaxed", [](Config& c) {
    c.model.relaxed = true;
    c.training.stages[1].networks.push_back(Network::kMotion);
  });
  // Learning depth alone is learning by the warp.
  expect("no-warp", [](Config& c) {
    c.model.warp = false;
    c.training.stages.clear();
  });
  expect("more-terms", [](Config& c) {
    c.model.pose_loss = PoseLossKind::kJs;
    c.model.smoothness = 0.01;
    c.model.pose_contrast = 0.1;
  });
}

TEST(Config, ABaseIsFilledIn) {
  Config expected = Config::load("small");
  expected.model.slots = 5;
  expected.training.stages[0].steps = 7;
  const char* text = R"({"base": "small", "model": {"slots": 5}})";
  EXPECT_EQ(Config::parse(text, "x", std::vector<std::string>{"training.stages[0].steps=7"}), expected);
  EXPECT_EQ(Config::parse(R"({"base": "relaxed", "model": {"relaxed": false}})", "x"), Config::load("small"));
  EXPECT_EQ(refusal(R"({"base": "larger"})"),
            "run.json: base is \"larger\"; give a preset, one of full, more-terms, no-regularisers, no-warp, "
            "relaxed, rooms-small, rotation-3d, small, tiny");
  EXPECT_NE(refusal(R"({"base": 3})").find("base is 3"), std::string::npos);
  EXPECT_NE(refusal(R"({"base": "small", "model": 3})").find("model is 3"), std::string::npos);
}

TEST(Config, MotionIsANetworkOfTheRelaxedModel) {
  EXPECT_EQ(Config::parse(R"({"model": {"relaxed": true}})", "x").stages()[0].networks.back(),
            Network::kMotion);
  const Config c = Config::parse(
      R"({"model": {"relaxed": true}, "training": {"clip": {"motion": 3}, "stages": [{"networks": ["motion"]}]}})",
      "x");
  EXPECT_EQ(c.stages()[0].networks, std::vector<Network>{Network::kMotion});
  EXPECT_EQ(c.training.clip.motion, 3);
  EXPECT_NE(refusal(R"({"training": {"stages": [{"networks": ["motion"]}]}})").find("model.relaxed"),
            std::string::npos);
}

TEST(Config, WithoutStagesOneTrainsEverything) {
  const Config c =
      Config::parse(R"({"training": {"batch": 3, "learning_rate": 0.5}, "rooms": {"objects": 2}})", "x");
  ASSERT_EQ(c.stages().size(), 1U);
  const TrainingStage all = c.stages()[0];
  EXPECT_TRUE(all.learns(Network::kDepth) && all.learns(Network::kObject) && all.learns(Network::kImagination));
  EXPECT_EQ(all.batch, 3);
  EXPECT_EQ(all.learning_rate, 0.5);
  EXPECT_EQ(all.rooms.objects, 2);
}

TEST(Config, FixtureMetadataIsAModel) {
  const ModelConfig c = ModelConfig::parse(
      R"({"height": 32, "width": 32, "fov": 1.5707963267948966, "slots": 3, "bins": 120, "identity": 10, "code": 64,
          "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 16, "max_depth": 7.2, "max_height": 5.0, "beta": 1.0,
          "reg": 1.0, "warp": false, "relaxed": false, "pose_loss": "js", "dropout": [0, 0, 0]})",
      "fixture");
  EXPECT_EQ(c.fov, ModelConfig{}.fov);
  EXPECT_EQ(c.imagine_width, 1);
  EXPECT_FALSE(c.warp);
  EXPECT_EQ(c.pose_loss, PoseLossKind::kJs);
  EXPECT_EQ(c.dropout[0], 0);
}

TEST(Config, RefusalsNameFileKeyAndRange) {
  EXPECT_EQ(refusal(R"({"model": {"height": 0}})"),
            "run.json: model.height is 0; give a whole number from 4 to 4096");
  EXPECT_EQ(refusal(R"({"model": {"slots": "3"}})"),
            "run.json: model.slots is \"3\"; give a whole number from 1 to 254");
  EXPECT_EQ(refusal(R"({"model": {"slots": 2.5}})"),
            "run.json: model.slots is 2.5; give a whole number from 1 to 254");
  EXPECT_EQ(refusal(R"({"model": {"pose_loss": "l2"}})"),
            "run.json: model.pose_loss is \"l2\"; give one of kl, js");
  EXPECT_EQ(refusal(R"({"training": {"clip": {"depth": -1}}})"),
            "run.json: training.clip.depth is -1; give a number from 1e-09 to 1000000000");
  EXPECT_EQ(refusal(R"({"training": {"clip": {"depht": 1}}})"),
            "run.json: training.clip.depht is no key; the keys here are depth, object, imagination, motion");
  EXPECT_EQ(refusal(R"({"rooms": {"shapes": ["cube", "cube"]}})"),
            "run.json: rooms.shapes has cube twice; keep one");
  EXPECT_EQ(refusal(R"({"training": {"stages": [{"steps": 5, "rooms": {"size": [0.1]}}]}})"),
            "run.json: training.stages[0].rooms.size is [0.1]; give a list of 2 numbers from 0.05 to 1");
  EXPECT_EQ(refusal(R"({"model": 3})"), "run.json: model is 3; give an object {...}");
  EXPECT_EQ(refusal("[]"), "run.json: the text is []; give an object {...}");
}

TEST(Config, RefusesWhatCannotBe) {
  EXPECT_NE(refusal(R"({"model": {"relaxed": true, "orientation": "euler"}})").find("model.relaxed"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"model": {"pose_contrast": 1, "orientation": "euler"}})").find("model.pose_contrast"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"model": {"code": 4, "identity": 5}})").find("model.identity"), std::string::npos);
  EXPECT_NE(refusal(R"({"model": {"slots": 18446744073709551615}})").find("model.slots"), std::string::npos);
  EXPECT_NE(refusal(R"({"model": {"warp": 1}})").find("true or false"), std::string::npos);
  EXPECT_NE(refusal(R"({"rooms": {"size": [0.5, 0.25]}})").find("rooms.size"), std::string::npos);
  EXPECT_NE(refusal(R"({"rooms": {"shapes": []}})").find("rooms.shapes"), std::string::npos);
  EXPECT_NE(refusal(R"({"training": {"stages": [{"name": "a"}, {"name": "b"}]}})").find("stages[0].steps"),
            std::string::npos);
  EXPECT_NE(
      refusal(R"({"training": {"stages": [{"name": "a", "steps": 1}, {"name": "a"}]}})").find("stages[1].name"),
      std::string::npos);
  EXPECT_NE(refusal(R"({"training": {"stages": [{"hypotheses": "background"}]}})").find("stages[0].networks"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"training": {"stages": [{"name": "../a"}]}})").find("stages[0].name"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"training": {"learning_rate": 1e999}})").find("run.json"), std::string::npos);
}

TEST(Config, RefusesDamagedText) {
  EXPECT_EQ(refusal(R"({"model": {"height": 32, "height": 64}})"),
            "run.json: key model.height appears twice; keep one");
  EXPECT_NE(refusal(R"({"model": )").find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusal("").find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusal(std::string(100000, '[')).find("nested deeper"), std::string::npos);
  refusal("{\"a\\nb\": 1}");
  refusal("{\"\xff\": 1}");
}

TEST(Config, LoadTellsPresetsFromFiles) {
  try {
    Config::load("smal");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_STREQ(
        error.what(),
        "smal: no such file, nor a preset; the presets are full, more-terms, no-regularisers, no-warp, "
        "relaxed, rooms-small, rotation-3d, small, tiny");
  }
  const std::string path = testing::TempDir() + "vkopple_config_test.json";
  std::ofstream(path) << R"({"model": {"height": 48}})";
  EXPECT_EQ(Config::load(path).model.height, 48);
  std::filesystem::resize_file(path, std::uintmax_t{1} << 21);
  EXPECT_THROW(Config::load(path), Error);
  std::filesystem::remove(path);
  EXPECT_THROW(Config::load(testing::TempDir()), Error);
}

Config with(const std::vector<std::string>& overrides) { return Config::load("small", overrides); }

/// The message with which overrides are refused as wrong use.
std::string wrong_use(const std::string& assignment) {
  try {
    with({assignment});
  } catch (const UsageError& error) {
    return error.what();
  }
  ADD_FAILURE() << "accepted: " << assignment;
  return {};
}

TEST(Config, OverridesReplaceSingleValues) {
  const Config c = with({"model.statistics_frames=all", "model.reg=0.25", "model.dropout=[0,0,0.5]",
                         "training.stages[0].steps=7", "training.clip.depth=1e-3", "rooms.speed=0.1"});
  Config expected = Config::load("small");
  expected.model.statistics_frames = StatisticsFrames::kAll;
  expected.model.reg = 0.25;
  expected.model.dropout = {0, 0, 0.5};
  expected.training.stages[0].steps = 7;
  expected.training.clip.depth = 1e-3;
  expected.rooms.speed = 0.1;
  expected.training.stages[1].rooms.speed = 0.1;  // it takes over what the rooms say
  EXPECT_EQ(c, expected) << c.to_json();
  EXPECT_EQ(with({"model.slots=2", "model.slots=4"}).model.slots, 4);
  EXPECT_EQ(Config::parse("{}", "x", std::vector<std::string>{"model.height=32"}).model.height, 32);
}

TEST(Config, OverridesAreReadStrictly) {
  const auto refused = [](const std::string& assignment) -> std::string {
    try {
      with({assignment});
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refused("model.statistics_frames=first"),
            "preset small with --set: model.statistics_frames is \"first\"; give one of all, second");
  EXPECT_NE(refused("model.hight=3").find("model.hight is no key"), std::string::npos);
  EXPECT_NE(refused("trainings.batch=3").find("trainings is no key"), std::string::npos);
  EXPECT_NE(refused("model.height=3x").find("model.height is \"3x\""), std::string::npos);
  EXPECT_NE(refused("model=3").find("give an object"), std::string::npos);
  EXPECT_NE(refused("model={\"slots\":2,\"slots\":3}").find("appears twice"), std::string::npos);
}

TEST(Config, OverridesThatAreNoneAreWrongUse) {
  EXPECT_EQ(wrong_use("model.reg"), "--set model.reg: give KEY=VALUE, as model.reg=0.5");
  for (const char* key :
       {"", ".", "model.", ".model", "model..reg", "model reg", "training.stages[", "training.stages[]",
        "training.stages[0", "training.stages[-1]", "training.stages[x].steps", "model[\"reg\"]"})
    EXPECT_NE(wrong_use(std::string(key) + "=1").find("is no key"), std::string::npos) << key;
  EXPECT_NE(wrong_use("training.stages[2].steps=1").find("its list has 2"), std::string::npos);
  EXPECT_NE(wrong_use("model.height[0]=1").find("its list has 0"), std::string::npos);
  EXPECT_NE(wrong_use("model.height.x=1").find("asks for a part of model.height"), std::string::npos);
}

TEST(Config, StagesHaveSchedulesAndWeightsOfTheirOwn) {
  const Config c = Config::parse(R"({"training": {"stages": [
    {"name": "a", "steps": 100, "learning_rate": 0.5, "warmup": 10, "final_learning_rate": 0.1, "reg": 0.25,
     "slot_contrast": 3, "slots": 2},
    {"name": "b", "learning_rate": 0.25}]}})",
                                 "x");
  const TrainingStage a = c.stages()[0];
  EXPECT_EQ(a.reg, 0.25);
  EXPECT_EQ(a.model_in(c.model).reg, 0.25);
  EXPECT_EQ(a.model_in(c.model).slot_contrast, 3);
  EXPECT_EQ(a.model_in(c.model).slots, 2);
  EXPECT_NEAR(a.learning_rate_at(0), 0.05, 1e-12);
  EXPECT_NEAR(a.learning_rate_at(4), 0.5 * (0.1 + 0.4 * (1 + std::cos(std::numbers::pi * 0.04)) / 2), 1e-12);
  EXPECT_NEAR(a.learning_rate_at(50), 0.3, 1e-12);
  EXPECT_NEAR(a.learning_rate_at(100), 0.1, 1e-12);
  EXPECT_NEAR(a.learning_rate_at(1000), 0.1, 1e-12);
  const TrainingStage b = c.stages()[1];
  EXPECT_FALSE(b.reg || b.final_learning_rate);
  EXPECT_EQ(b.model_in(c.model), c.model);
  EXPECT_EQ(b.learning_rate_at(12345), 0.25);
  EXPECT_EQ(Config::parse(c.to_json(), "y"), c);
  EXPECT_NE(refusal(R"({"training": {"stages": [{"name": "a", "final_learning_rate": 0.1}]}})").find("steps"),
            std::string::npos);
}

}  // namespace
}  // namespace vkopple
