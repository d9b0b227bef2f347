#include "train/evaluation_scores.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/error.h"

namespace vkopple {
namespace {

const LabelledLocation* find(std::span<const LabelledLocation> objects, std::int32_t label) {
  const auto found =
      std::find_if(objects.begin(), objects.end(), [&](const auto& o) { return o.label == label; });
  return found == objects.end() ? nullptr : &*found;
}

}  // namespace

double LabelledLocation::angle() const { return std::atan2(x, y); }
double LabelledLocation::distance() const { return std::hypot(x, y); }

std::vector<MatchedObject> matched_objects(const EvaluatedImage& image, std::span<const Match> matches) {
  std::vector<MatchedObject> all;
  for (const Match& match : matches) {
    if (match.true_label <= 0 || !match.predicted_label) continue;
    const LabelledLocation* truth = find(image.true_objects, match.true_label);
    const LabelledLocation* predicted = find(image.predicted_objects, *match.predicted_label);
    if (truth != nullptr && predicted != nullptr) all.push_back({*truth, *predicted, match.iou});
  }
  return all;
}

void EvaluationScores::Mean::add(const std::optional<double>& value) {
  if (!value) return;
  sum_ += *value;
  ++count_;
}

std::optional<double> EvaluationScores::Mean::value() const {
  if (count_ == 0) return std::nullopt;
  return sum_ / static_cast<double>(count_);
}

void EvaluationScores::add(const EvaluatedImage& image) {
  if (image.true_depth.size() != image.predicted_depth.size()) {
    throw Error(fmt::format("depth maps of {} and {} pixels can't be compared", image.true_depth.size(),
                            image.predicted_depth.size()));
  }
  const auto finite = [](float depth) { return std::isfinite(depth); };
  if (!std::all_of(image.predicted_depth.begin(), image.predicted_depth.end(), finite)) {
    throw Error("an inferred depth is not a finite number; the model's weights are unusable");
  }
  const bool labelled = !image.true_labels.empty();
  std::optional<double> ari;
  std::vector<Match> matches;
  if (labelled) {
    ari = ari_foreground(image.true_labels, image.predicted_labels);
    matches = match_entities(image.true_labels, image.predicted_labels);
  }
  ++images_;
  places_ += static_cast<std::int64_t>(image.true_objects.size());
  add_depth(image);
  if (!labelled) {
    ++without_masks_;
    return;
  }
  if (!ari) ++skipped_;
  ari_fg_.add(ari);
  if (object_count(image.true_labels) >= 2) ari_fg_multi_.add(ari);
  iou_.add(mean_iou(matches));
  iou_objects_.add(mean_iou_objects(matches));
  add_locations(image, matches);
}

void EvaluationScores::add_depth(const EvaluatedImage& image) {
  Correlation here;
  for (std::size_t i = 0; i < image.true_depth.size(); ++i) {
    const double truth = image.true_depth[i], predicted = image.predicted_depth[i];
    if (!std::isfinite(truth) || truth <= 0) continue;
    here.add(truth, predicted);
    depth_pooled_.add(truth, predicted);
  }
  if (here.count() == 0) ++without_depth_;
  depth_r_.add(here.r());
}

void EvaluationScores::add_locations(const EvaluatedImage& image, std::span<const Match> matches) {
  for (const auto& [truth, predicted, iou] : matched_objects(image, matches)) {
    angle_.add(truth.angle(), predicted.angle());
    distance_.add(truth.distance(), predicted.distance());
    if (iou <= kGoodIou) continue;
    angle_good_.add(truth.angle(), predicted.angle());
    distance_good_.add(truth.distance(), predicted.distance());
  }
}

Json EvaluationScores::scores_json() const {
  const auto value = [](const std::optional<double>& score) { return score ? Json(*score) : Json(nullptr); };
  return {{"ari_fg", value(ari_fg())},
          {"ari_fg_multi", value(ari_fg_multi())},
          {"iou", value(iou())},
          {"iou_objects", value(iou_objects())},
          {"depth_r", value(depth_r())},
          {"depth_r_pooled", value(depth_r_pooled())},
          {"angle_r", value(angle_r())},
          {"distance_r", value(distance_r())},
          {"angle_r_good", value(angle_r_good())},
          {"distance_r_good", value(distance_r_good())}};
}

Json EvaluationScores::counts_json() const {
  return {{"images", images_},
          {"skipped", skipped_},
          {"without_masks", without_masks_},
          {"without_depth", without_depth_}};
}

Json EvaluationScores::to_json() const {
  Json json = scores_json();
  json.update(counts_json());
  return json;
}

std::vector<NamedScore> EvaluationScores::named() const {
  return {{"ARI-fg", ari_fg()},
          {"ARI-fg, two objects or more", ari_fg_multi()},
          {"IoU", iou()},
          {"IoU of objects", iou_objects()},
          {"depth r, mean over images", depth_r()},
          {"depth r, all pixels", depth_r_pooled()},
          {"angle r", angle_r()},
          {"distance r", distance_r()},
          {"angle r, IoU > 0.5", angle_r_good()},
          {"distance r, IoU > 0.5", distance_r_good()}};
}

std::string score_table(const std::vector<ScoreColumn>& columns) {
  std::string text;
  const auto add_row = [&](const std::string& name, const auto& cell) {
    text += fmt::format("{:<28}", name);
    for (const ScoreColumn& column : columns)
      text += fmt::format("{:>{}}", cell(column), std::max<std::size_t>(8, column.title.size() + 2));
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  };
  if (columns.size() > 1) add_row("", [](const ScoreColumn& column) { return column.title; });
  const std::vector<NamedScore> rows = columns.at(0).scores->named();
  for (size_t row = 0; row < rows.size(); ++row)
    add_row(rows[row].name, [&](const ScoreColumn& column) {
      const std::optional<double> value = column.scores->named()[row].value;
      return value ? fmt::format("{:.3f}", *value) : std::string("-");
    });
  const auto add_count = [&](const char* name, std::int64_t count) {
    add_row(name, [&](const ScoreColumn& column) {
      return &column == columns.data() ? std::to_string(count) : std::string();
    });
  };
  add_count("images", columns.at(0).scores->images());
  add_count("  without foreground", columns.at(0).scores->skipped());
  return text;
}

std::vector<std::string> EvaluationScores::left_out() const {
  std::vector<std::string> lines;
  const auto say = [&](std::int64_t count, const char* what, const char* of) {
    if (count > 0)
      lines.push_back(fmt::format("{} of {} images have no true {}: {}", count, images_, what, of));
  };
  say(without_masks_, "masks", "left out of ARI, IoU, angles and distances");
  say(without_depth_, "depth", "left out of the correlation of depth");
  const std::int64_t with_foreground = images_ - without_masks_ - skipped_;
  if (with_foreground > 0 && places_ == 0)
    lines.emplace_back("where objects are is not known: no angles and distances");
  return lines;
}

}  // namespace vkopple
