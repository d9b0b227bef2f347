#include "train/formats/data_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/small_scene.h"

namespace vkopple {
namespace {

using test::small_scene;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(DataSummary, CountsAndMeasures) {
  DataSummary summary;
  summary.add(small_scene(1, 3));
  summary.add(small_scene(2, 5));
  EXPECT_THAT(summary.warnings(), ElementsAre());
  const auto json = summary.to_json();
  EXPECT_EQ(json["scenes"], 2);
  EXPECT_EQ(json["frames_a_scene"]["mean"], 4);
  EXPECT_EQ(json["triplets"], 1 + 4);
  EXPECT_EQ(json["sizes"].size(), 1U);
  EXPECT_EQ(json["sizes"][0]["frames"], 8);
  EXPECT_NEAR(json["fov"]["max"], 71.6197243913529, 1e-9);
  EXPECT_NEAR(json["camera"]["step"]["mean"], 0.25, 1e-9);
  EXPECT_NEAR(json["camera"]["turn"]["max"], 5.729577951308232, 1e-9);
  EXPECT_NEAR(json["camera"]["height"]["min"], 0.7, 1e-9);
  EXPECT_EQ(json["camera"]["missing"], 0);
  EXPECT_EQ(json["depth"]["range"]["min"], 1.0 / 16);
  EXPECT_EQ(json["depth"]["range"]["max"], 27.0 / 16);
  EXPECT_NEAR(json["depth"]["unknown_share"], 2.0 / (24 * 8), 1e-12) << "one pixel of each first frame";
  EXPECT_NEAR(json["labels"]["object_share"]["mean"], 2.0 / 3, 1e-12);
  EXPECT_EQ(json["objects"]["count"]["max"], 2);
  EXPECT_THAT(summary.to_text(), HasSubstr("camera step           0.25\n"));
  EXPECT_THAT(summary.to_text(), HasSubstr("angle of view         71.62 degrees, vertical\n"));
  EXPECT_THAT(summary.to_text(), HasSubstr("frames a scene        3 to 5, mean 4\n"));
}

TEST(DataSummary, SaysWhatIsOdd) {
  const auto warnings = [](const SceneData& scene) {
    DataSummary summary;
    summary.add(scene);
    return summary.warnings();
  };
  SceneData still = small_scene(1, 3);
  for (SceneFrame& frame : still.frames) frame.camera = CameraPose{};
  EXPECT_THAT(warnings(still), ElementsAre(HasSubstr("stands still in 1 of 1")));
  SceneData flat = small_scene(1, 3);
  for (SceneFrame& frame : flat.frames) std::fill_n(frame.depth.pixels.begin(), 12, 50.0F);
  EXPECT_THAT(warnings(flat), ElementsAre(HasSubstr("depth is saturated: 50 %")));
  SceneData blind = small_scene(1, 3);
  blind.frames[2].camera.reset();
  EXPECT_THAT(warnings(blind), ElementsAre(HasSubstr("1 of 3 frames have no camera")));
  EXPECT_THAT(warnings(small_scene(1, 2)), ElementsAre(HasSubstr("1 of 1 scenes have less than")));
  SceneData tilted = small_scene(1, 3);
  (*tilted.frames[1].camera)[4] = -1.5;
  EXPECT_THAT(warnings(tilted), ElementsAre(HasSubstr("tilted")));
  DataSummary mixed;
  mixed.add(small_scene(1, 3));
  SceneData other = small_scene(2, 3);
  other.fov = 1;
  for (SceneFrame& frame : other.frames) frame = {.image = RgbImage(3, 3), .camera = frame.camera};
  mixed.add(other);
  EXPECT_THAT(mixed.warnings(), ElementsAre(HasSubstr("2 sizes"), HasSubstr("angles of view")));
  EXPECT_THAT(DataSummary().warnings(), ElementsAre("no scenes"));
  EXPECT_THAT(DataSummary().to_text(), HasSubstr("depth                 unknown\n"));
  EXPECT_THAT(DataSummary().to_text(), HasSubstr("camera turn           unknown\n"));
}

}  // namespace
}  // namespace vkopple
