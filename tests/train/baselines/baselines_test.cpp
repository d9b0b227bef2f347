#include "train/baselines/baselines.h"

#include <gtest/gtest.h>

#include <limits>

namespace vkopple {
namespace {

constexpr std::int64_t kSlots = 2;

/// Grey pictures of one row, black outside of objects, each of which has a grey of its own.
struct Row {
  std::vector<std::int32_t> labels;
  std::vector<float> depth;
  std::vector<float> image;
  std::vector<LabelledLocation> objects;

  explicit Row(std::vector<std::int32_t> truth) : labels(std::move(truth)) {
    for (int c = 0; c < 3; ++c)
      for (const std::int32_t label : labels) image.push_back(0.5F * static_cast<float>(label));
    for (std::size_t p = 0; p < labels.size(); ++p) depth.push_back(static_cast<float>(p + 1));
  }
  ImageTruth truth() const {
    return {.height = 1,
            .width = static_cast<int>(labels.size()),
            .image = image,
            .labels = labels,
            .depth = depth,
            .objects = objects};
  }
};

/// Of baselines by name.
const EvaluationScores& scores(const Baselines& baselines, const std::string& name) {
  for (const ScoreColumn& column : baselines.columns())
    if (column.title == name) return *column.scores;
  throw std::out_of_range(name);
}

TEST(Baselines, KnownScoresOfTwoObjects) {
  Row row({0, 0, 0, 0, 0, 1, 1, 0, 2, 0});
  row.objects = {{1, 1, 2}, {2, -1, 1}};
  Row other({1, 0, 0, 0, 0, 0, 2, 2, 0, 0});
  other.objects = {{1, 0, 3}, {2, 2, 1}};
  Baselines baselines(kSlots);
  baselines.add(row.truth());
  baselines.add(other.truth());

  for (const char* name : {"background", "one object"}) {
    const EvaluationScores& same = scores(baselines, name);
    EXPECT_EQ(same.images(), 2) << name;
    EXPECT_DOUBLE_EQ(*same.ari_fg(), 0) << name;
    EXPECT_DOUBLE_EQ(*same.iou(), 0.7 / 3) << name;
    EXPECT_DOUBLE_EQ(*same.iou_objects(), 0) << name;
    EXPECT_EQ(same.depth_r(), std::nullopt) << name;
    EXPECT_EQ(same.angle_r(), std::nullopt) << name;
  }
  for (const char* name : {"k-means", "truth"}) {
    EXPECT_DOUBLE_EQ(*scores(baselines, name).ari_fg(), 1) << name;
    EXPECT_DOUBLE_EQ(*scores(baselines, name).iou(), 1) << name;
  }
  EXPECT_EQ(scores(baselines, "k-means").depth_r(), std::nullopt);
  const EvaluationScores& truth = baselines.truth();
  EXPECT_DOUBLE_EQ(*truth.depth_r(), 1);
  EXPECT_NEAR(*truth.angle_r(), 1, 1e-12);
  EXPECT_NEAR(*truth.distance_r_good(), 1, 1e-12);
}

TEST(Baselines, OneObjectIsOneCluster) {
  Baselines baselines(kSlots);
  baselines.add(Row({0, 0, 1, 1}).truth());
  EXPECT_DOUBLE_EQ(*scores(baselines, "one object").ari_fg(), 1);
  EXPECT_DOUBLE_EQ(*scores(baselines, "one object").iou(), 0.25);
  EXPECT_EQ(scores(baselines, "one object").ari_fg_multi(), std::nullopt);
}

TEST(Baselines, OfMoreObjectsThanSlotsTheLargestAreKept) {
  Row row({0, 0, 7, 2, 2, 2, 3, 3, 9, 9});
  row.objects = {{2, 1, 1}, {3, -1, 1}, {9, 5, 5}};
  Baselines baselines(kSlots);
  baselines.add(row.truth());
  const EvaluationScores& truth = baselines.truth();
  // 2 and 3 are kept; the background of 5 pixels holds 2 of its own.
  EXPECT_DOUBLE_EQ(*truth.iou_objects(), (1 + 1 + 0 + 0) / 4.0);
  EXPECT_DOUBLE_EQ(*truth.iou(), (0.4 + 1 + 1 + 0 + 0) / 5.0);
}

TEST(Baselines, RandomMasksAreBadAndAlwaysTheSame) {
  std::vector<std::int32_t> labels(3000, 0);
  for (std::size_t p = 0; p < 2000; ++p) labels[p] = p < 1000 ? 1 : 2;
  const auto random_json = [&](int before) {
    Baselines baselines(kSlots);
    for (int i = 0; i < before; ++i) baselines.add(Row({0, 1}).truth());
    baselines.add(Row(labels).truth());
    return baselines.to_json().at("random");
  };
  const Json once = random_json(0);
  EXPECT_NEAR(once.at("ari_fg").get<double>(), 0, 0.01);
  EXPECT_NEAR(once.at("iou").get<double>(), 0.2, 0.02);
  EXPECT_EQ(once, random_json(0));
  EXPECT_NE(once.at("ari_fg_multi"), random_json(1).at("ari_fg_multi")) << "other images have other masks";
}

TEST(Baselines, WhatIsUnknownIsNotScored) {
  Row row({0, 1, 0, 2});
  row.depth[2] = std::numeric_limits<float>::infinity();
  Baselines baselines(kSlots);
  baselines.add(row.truth());
  row.labels.clear();
  baselines.add(row.truth());
  row.labels = {0, 1, 1, 0};
  row.depth.clear();
  baselines.add(row.truth());
  EXPECT_EQ(baselines.truth().images(), 3);
  EXPECT_EQ(baselines.truth().without_masks(), 1);
  EXPECT_EQ(baselines.truth().without_depth(), 1);
  EXPECT_DOUBLE_EQ(*baselines.truth().depth_r(), 1);
  EXPECT_DOUBLE_EQ(*baselines.truth().iou(), 1);
  EXPECT_EQ(scores(baselines, "k-means").without_masks(), 1);
}

TEST(Baselines, NamesInJsonAndBesideOneAnother) {
  Baselines baselines(kSlots);
  baselines.add(Row({0, 1, 1, 0, 2}).truth());
  const Json json = baselines.to_json();
  EXPECT_EQ(json.size(), 5U);
  EXPECT_EQ(json.at("one_object").size(), 10U);
  EXPECT_TRUE(json.at("background").at("depth_r").is_null());
  EXPECT_EQ(json.at("truth").at("iou"), 1.0);
  EXPECT_TRUE(json.contains("k_means"));
  const std::string table = score_table(baselines.columns());
  EXPECT_TRUE(
      table.starts_with("                              background  one object  random  k-means   truth\n"))
      << table;
  EXPECT_NE(table.find("\nARI-fg                             0.000       0.000"), std::string::npos) << table;
  EXPECT_NE(table.find("\ndepth r, mean over images              -           -       -        -   1.000\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("\nimages                                 1\n"), std::string::npos) << table;
}

}  // namespace
}  // namespace vkopple
