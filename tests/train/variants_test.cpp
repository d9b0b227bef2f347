#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "models/perception.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "train/checkpoint.h"
#include "train/model_store.h"
#include "train/progress.h"
#include "train/seen_image.h"
#include "train/trainer.h"

namespace vkopple {
namespace {

/// A preset, made small, and how it is changed beyond that.
struct Variant {
  std::string name;
  std::string preset;
  std::vector<std::string> changes;
};

Config small(const Variant& variant) {
  std::vector<std::string> overrides{"model.height=16",     "model.width=16",       "model.bins=12",
                                     "model.depth_width=2", "model.object_width=4", "model.imagine_width=1",
                                     "model.lstm=4",        "training.stages=[]",   "training.batch=2",
                                     "rooms.frames=3",      "rooms.supersample=1"};
  overrides.insert(overrides.end(), variant.changes.begin(), variant.changes.end());
  return Config::load(variant.preset, overrides);
}

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

class VariantsTest : public testing::TestWithParam<Variant> {};

// Whether losses go down takes longer than a test may; that every network learns, and that what it has learned
// can be used, does not.
TEST_P(VariantsTest, TrainsEveryNetworkAndSees) {
  const test::TempFolder folder;
  const Config config = small(GetParam());
  ModelStore before(test_device(), config.model);
  before.initialise(9);
  const std::unique_ptr<std::FILE, Close> sink(std::tmpfile());
  Progress progress(sink.get(), false, 3);
  TrainerOptions options{.folder = RunFolder(folder / "run"), .data = "rooms:1", .steps = 3, .seed = 9};
  options.eval_every = 0;
  EXPECT_TRUE(Trainer(test_device(), config, options, false).run(progress, [] { return false; }));

  ModelStore after(test_device(), config.model);
  load_checkpoint(RunFolder(folder / "run").latest(), after, config);
  std::map<std::string, bool> learned;
  for (const LayoutEntry& weight : after.layout().weights())
    learned[weight.group] = learned[weight.group] || before.read(weight) != after.read(weight);
  EXPECT_EQ(learned.contains("motion"), config.model.relaxed);
  for (const auto& [group, changed] : learned) EXPECT_TRUE(changed) << group;

  Perception model(test_device(), config.model, after.groups());
  RgbImage image(config.model.height, config.model.width);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = 0.5F + 0.4F * std::sin(0.7F * static_cast<float>(i));
  const SeenImage seen = see_image(model, image);
  ASSERT_EQ(seen.objects.size(), static_cast<size_t>(config.model.slots));
  const bool spatial = config.model.orientation == Orientation::kEuler;
  for (const SeenObject& object : seen.objects) EXPECT_EQ(object.rotation.has_value(), spatial);
  EXPECT_EQ(to_json(seen).at("objects").at(0).contains(spatial ? "rotation" : "yaw"), true);
}

INSTANTIATE_TEST_SUITE_P(
    Presets, VariantsTest,
    testing::Values(Variant{"relaxed", "relaxed", {}}, Variant{"rotation_3d", "rotation-3d", {}},
                    Variant{"no_warp", "no-warp", {}}, Variant{"no_regularisers", "no-regularisers", {}},
                    Variant{"more_terms", "more-terms", {}},
                    Variant{"wide",
                            "small",
                            {"model.height=12", "model.width=27", "model.fov=1", "model.slots=5",
                             "model.bins=181"}},
                    Variant{"tall_one_slot",
                            "relaxed",
                            {"model.height=21", "model.width=10", "model.slots=1", "model.bins=1"}}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace vkopple
