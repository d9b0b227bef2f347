#include "train/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "tests/support/expect_error.h"
#include "tests/support/fixture.h"
#include "train/json_io.h"

namespace vkopple {
namespace {

using test::expect_error;
using Labels = std::vector<std::int32_t>;

void expect_score(const std::optional<double>& score, const Json& expected, const std::string& what) {
  ASSERT_EQ(score.has_value(), !expected.is_null()) << what;
  if (!score) return;
  EXPECT_NEAR(*score, expected.get<double>(), 1e-9) << what;
}

TEST(Metrics, ReproduceTheFixture) {
  const Json cases = read_json(test::fixture("metrics.json"));
  ASSERT_EQ(cases.size(), 12u);
  for (const Json& c : cases) {
    const auto name = c.at("name").get<std::string>();
    const auto truth = c.at("true").get<Labels>(), predicted = c.at("predicted").get<Labels>();
    const auto matches = match_entities(truth, predicted);
    expect_score(ari_foreground(truth, predicted), c.at("ari_fg"), name + " ari_fg");
    expect_score(mean_iou(matches), c.at("iou"), name + " iou");
    expect_score(mean_iou_objects(matches), c.at("iou_objects"), name + " iou_objects");
  }
}

TEST(Metrics, OneTrueObject) {
  const Labels truth{0, 5, 5, 5};
  EXPECT_EQ(ari_foreground(truth, Labels{1, 1, 1, 1}), 1.0);
  EXPECT_EQ(ari_foreground(truth, Labels{1, 2, 2, 3}), 0.0);
  EXPECT_EQ(ari_foreground(truth, Labels{1, 2, 3, 4}), 0.0);
  EXPECT_EQ(ari_foreground(Labels{0, 1}, Labels{0, 0}), 1.0);  // a single pixel
  EXPECT_EQ(ari_foreground(Labels{0, 0}, Labels{0, 1}), std::nullopt);
  EXPECT_EQ(object_count(truth), 1u);
  EXPECT_EQ(object_count(Labels{0, 3, 1, 3}), 2u);
}

TEST(Metrics, AriByHand) {
  // Pairs together: both 1 (of 2 and 2), expected 2 * 2 / 6.
  EXPECT_NEAR(*ari_foreground(Labels{1, 1, 2, 2}, Labels{1, 1, 2, 3}), (1 - 2.0 / 6) / (1.5 - 2.0 / 6), 1e-15);
  EXPECT_LT(*ari_foreground(Labels{1, 1, 2, 2}, Labels{1, 2, 1, 2}), 0);
  EXPECT_EQ(ari_foreground(Labels{1, 2, 3}, Labels{7, 8, 9}), 1.0);  // each alone in both
}

TEST(Metrics, AriOfManyPixelsIsExact) {
  Labels truth(1 << 20), predicted(1 << 20);
  for (std::size_t i = 0; i < truth.size(); ++i)
    truth[i] = 1 + static_cast<std::int32_t>(i % 2), predicted[i] = truth[i] * 10;
  EXPECT_EQ(ari_foreground(truth, predicted), 1.0);
}

TEST(Metrics, MatchingIsGreedyAndEqualsGoByLabel) {
  //           IoU of (1, 8) is 2/3 and goes first; (2, 8) is then gone.
  const auto matches = match_entities(Labels{1, 1, 2, 3, 0}, Labels{8, 8, 8, 9, 9});
  ASSERT_EQ(matches.size(), 4u);
  EXPECT_EQ(matches[1].predicted_label, 8);
  EXPECT_NEAR(matches[1].iou, 2.0 / 3, 1e-15);
  EXPECT_EQ(matches[2].predicted_label, std::nullopt);
  EXPECT_EQ(matches[2].iou, 0);
  EXPECT_EQ(matches[0].predicted_label, 9);  // ties with 3; background has the smaller label
  EXPECT_EQ(matches[3].predicted_label, std::nullopt);
  EXPECT_NEAR(*mean_iou(matches), (2.0 / 3 + 0.5) / 4, 1e-15);
  EXPECT_NEAR(*mean_iou_objects(matches), 2.0 / 9, 1e-15);
  EXPECT_EQ(match_entities(Labels{1, 1}, Labels{7, 4})[0].predicted_label, 4);  // the smaller predicted label
}

TEST(Metrics, RefuseMapsThatDoNotFit) {
  expect_error([] { ari_foreground(Labels{1, 2}, Labels{1}); }, {"2 and 1 pixels"});
  expect_error([] { match_entities(Labels{}, Labels{}); }, {"0 and 0 pixels"});
  Labels many(5000);
  std::iota(many.begin(), many.end(), 0);
  expect_error([&] { match_entities(many, many); }, {"more than 4096 labels"});
}

std::optional<double> correlate(const std::vector<double>& x, const std::vector<double>& y) {
  Correlation c;
  for (std::size_t i = 0; i < x.size(); ++i) c.add(x[i], y[i]);
  return c.r();
}

TEST(Correlation, ByHand) {
  EXPECT_NEAR(*correlate({1, 2, 3, 4}, {1, 3, 2, 5}), 5.5 / std::sqrt(5 * 8.75), 1e-14);
  EXPECT_DOUBLE_EQ(*correlate({1, 2, 3}, {2, 4, 6}), 1.0);
  EXPECT_DOUBLE_EQ(*correlate({1, 2, 3}, {6, 4, 2}), -1.0);
  // A large common offset must not drown the differences.
  EXPECT_NEAR(*correlate({1e9 + 1, 1e9 + 2, 1e9 + 3, 1e9 + 4}, {1, 3, 2, 5}), 5.5 / std::sqrt(5 * 8.75), 1e-9);
}

TEST(Correlation, UndefinedIsNothing) {
  EXPECT_EQ(correlate({}, {}), std::nullopt);
  EXPECT_EQ(correlate({1}, {1}), std::nullopt);
  EXPECT_EQ(correlate({1, 1, 1}, {1, 2, 3}), std::nullopt);
  EXPECT_EQ(correlate({1, 2, 3}, {2, 2, 2}), std::nullopt);
  EXPECT_EQ(correlate({1, std::nan(""), 3}, {1, 2, 3}), std::nullopt);
  EXPECT_EQ(correlate({1, 2, std::numeric_limits<double>::infinity()}, {1, 2, 3}), std::nullopt);
}

}  // namespace
}  // namespace vkopple
