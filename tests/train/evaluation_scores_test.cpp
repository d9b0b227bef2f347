#include "train/evaluation_scores.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/expect_error.h"

namespace vkopple {
namespace {

using Labels = std::vector<std::int32_t>;
using Depths = std::vector<float>;
using Locations = std::vector<LabelledLocation>;

void add(EvaluationScores& scores, const Labels& truth, const Labels& predicted, const Depths& depth = {},
         const Depths& inferred = {}, const Locations& objects = {}, const Locations& slots = {}) {
  scores.add({truth, predicted, depth, inferred, objects, slots});
}

TEST(EvaluationScores, NothingIsNull) {
  const EvaluationScores scores;
  const Json json = scores.to_json();
  EXPECT_EQ(json.size(), 14u);
  EXPECT_TRUE(scores.left_out().empty());
  for (const char* key : {"ari_fg", "ari_fg_multi", "iou", "iou_objects", "depth_r", "depth_r_pooled",
                          "angle_r", "distance_r", "angle_r_good", "distance_r_good"}) {
    EXPECT_TRUE(json.at(key).is_null()) << key;
  }
  EXPECT_EQ(json.at("images"), 0);
  EXPECT_EQ(json.at("skipped"), 0);
}

TEST(EvaluationScores, MeansOverImages) {
  EvaluationScores scores;
  add(scores, {0, 0, 1, 1}, {3, 3, 0, 1});  // one object, split: ARI 0; IoU 1 and 1/2
  add(scores, {0, 1, 1, 2}, {3, 0, 0, 1});  // perfect
  add(scores, {0, 0, 0, 0}, {3, 3, 3, 0});  // no foreground: IoU 3/4
  EXPECT_EQ(scores.images(), 3);
  EXPECT_EQ(scores.skipped(), 1);
  EXPECT_DOUBLE_EQ(*scores.ari_fg(), 0.5);
  EXPECT_DOUBLE_EQ(*scores.ari_fg_multi(), 1.0);
  EXPECT_DOUBLE_EQ(*scores.iou(), (0.75 + 1 + 0.75) / 3);
  EXPECT_DOUBLE_EQ(*scores.iou_objects(), 0.75);
  EXPECT_EQ(scores.to_json().at("ari_fg"), 0.5);
  const std::string table = score_table({{"model", &scores}});
  EXPECT_TRUE(table.starts_with("ARI-fg                         0.500\n")) << table;
  EXPECT_NE(table.find("depth r, all pixels                -\n"), std::string::npos) << table;
}

TEST(EvaluationScores, DepthWithoutSky) {
  const float inf = std::numeric_limits<float>::infinity();
  EvaluationScores scores;
  add(scores, {0, 0, 0, 0, 0}, {3, 3, 3, 3, 3}, {1, 2, 3, 0, inf}, {2, 4, 6, 100, -7});
  EXPECT_DOUBLE_EQ(*scores.depth_r(), 1);
  EXPECT_DOUBLE_EQ(*scores.depth_r_pooled(), 1);
  add(scores, {0, 0, 0}, {3, 3, 3}, {1, 2, 3}, {6, 4, 2});
  EXPECT_DOUBLE_EQ(*scores.depth_r(), 0);
  EXPECT_NEAR(*scores.depth_r_pooled(), 0, 1e-15);
  add(scores, {0, 0, 0}, {3, 3, 3}, {1, 2, 3}, {5, 5, 5});  // undefined for this image
  EXPECT_DOUBLE_EQ(*scores.depth_r(), 0);
}

TEST(EvaluationScores, ScoresWhatIsKnown) {
  EvaluationScores scores;
  add(scores, {}, {3, 3, 3}, {1, 2, 3}, {2, 4, 6});
  EXPECT_EQ(scores.images(), 1);
  EXPECT_EQ(scores.skipped(), 0) << "nobody knows whether there is foreground";
  EXPECT_DOUBLE_EQ(*scores.depth_r(), 1);
  EXPECT_EQ(scores.iou(), std::nullopt);
  add(scores, {1, 1, 0}, {0, 0, 3});
  EXPECT_EQ(scores.images(), 2);
  EXPECT_DOUBLE_EQ(*scores.depth_r(), 1);
  EXPECT_DOUBLE_EQ(*scores.iou(), 1);
}

TEST(EvaluationScores, LocationsOfMatchedVisibleObjects) {
  EvaluationScores scores;
  // Object 1 is slot 2 in part (IoU 1/2), 2 is slot 0; 3 is hidden; slot 1 shows nothing.
  const Labels truth{1, 1, 2, 2, 0, 0}, predicted{2, 3, 0, 0, 3, 3};
  const Locations objects{{1, 1, 1}, {2, -1, 1}, {3, 5, 5}};
  add(scores, truth, predicted, {}, {}, objects, {{0, -2, 2}, {1, 9, 9}, {2, 3, 3}});
  add(scores, truth, predicted, {}, {}, {{1, 0, 2}, {2, 0, 1}}, {{0, 0, 3}, {1, 9, 9}, {2, 0, 4}});
  const double a = std::atan(1.0);
  Correlation angle, distance;
  angle.add(a, a), angle.add(-a, -a), angle.add(0, 0), angle.add(0, 0);
  EXPECT_DOUBLE_EQ(*scores.angle_r(), *angle.r());
  for (const auto& [x, y] : {std::pair{1., 3.}, {1., 2.}}) distance.add(x * std::sqrt(2), y * std::sqrt(2));
  distance.add(2, 4), distance.add(1, 3);
  EXPECT_NEAR(*scores.distance_r(), *distance.r(), 1e-12);
  Correlation good;
  good.add(std::sqrt(2), 2 * std::sqrt(2)), good.add(1, 3);
  EXPECT_NEAR(*scores.distance_r_good(), *good.r(), 1e-12);
  EXPECT_NEAR(*scores.angle_r_good(), 1, 1e-12);
}

TEST(EvaluationScores, AnObjectTakenForBackgroundHasNoLocation) {
  EvaluationScores scores;
  const Locations objects{{1, 1, 1}}, slots{{0, 1, 1}, {1, 1, 1}};
  for (int i = 0; i < 3; ++i) add(scores, {1, 1, 1, 0}, {3, 3, 3, 3}, {}, {}, objects, slots);
  EXPECT_EQ(scores.angle_r(), std::nullopt);
}

TEST(EvaluationScores, WhatIsUnknownOfAnImageIsLeftOutAndTold) {
  EvaluationScores scores;
  add(scores, {0, 0, 1, 1}, {3, 3, 0, 0}, {0, 0, 0, 0}, {1, 2, 3, 4});  // no depth
  add(scores, {}, {3, 3, 0, 0}, {1, 2, 3, 4}, {1, 2, 3, 4});            // no masks
  add(scores, {0, 0, 1, 1}, {3, 3, 0, 0});
  EXPECT_EQ(scores.images(), 3);
  EXPECT_EQ(scores.skipped(), 0);
  EXPECT_DOUBLE_EQ(*scores.ari_fg(), 1);
  EXPECT_DOUBLE_EQ(*scores.iou(), 1);
  EXPECT_DOUBLE_EQ(*scores.depth_r(), 1);
  EXPECT_EQ(scores.to_json().at("without_masks"), 1);
  EXPECT_EQ(scores.to_json().at("without_depth"), 2);
  EXPECT_EQ(
      scores.left_out(),
      (std::vector<std::string>{"1 of 3 images have no true masks: left out of ARI, IoU, angles and distances",
                                "2 of 3 images have no true depth: left out of the correlation of depth",
                                "where objects are is not known: no angles and distances"}));
  add(scores, {0, 1}, {3, 3}, {}, {}, {{1, 1, 1}}, {});  // known, though nothing was matched with it
  EXPECT_EQ(scores.left_out().size(), 2u);
}

TEST(EvaluationScores, WhereNothingIsInSightNoPlacesAreMissed) {
  EvaluationScores scores;
  add(scores, {0, 0}, {3, 3}, {1, 2}, {1, 2});  // nothing in sight
  add(scores, {}, {3, 3}, {1, 2}, {1, 2});      // no masks
  EXPECT_EQ(scores.left_out().size(), 1u) << "masks";
  add(scores, {0, 1}, {3, 3}, {1, 2}, {1, 2});
  EXPECT_EQ(scores.left_out().size(), 2u);
}

TEST(EvaluationScores, RefusesMapsThatDoNotFitAndStaysAsItWas) {
  EvaluationScores scores;
  test::expect_error([&] { add(scores, {0, 1}, {0, 1}, {1, 2}, {1}); }, {"depth maps of 2 and 1"});
  test::expect_error([&] { add(scores, {0, 1}, {0}); }, {"2 and 1 pixels"});
  test::expect_error([&] { add(scores, {0, 1}, {0, 1}, {1, 2}, {1, std::nanf("")}); }, {"inferred depth"});
  EXPECT_EQ(scores.images(), 0);
}

}  // namespace
}  // namespace vkopple
