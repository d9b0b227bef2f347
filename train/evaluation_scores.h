#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "train/json_io.h"
#include "train/metrics.h"

namespace vkopple {

/// Where an object stands in the camera's frame: x right, y forward, scene units.
struct LabelledLocation {
  std::int32_t label;  ///< in the label map that shows it
  double x, y;

  double angle() const;     ///< atan2(x, y), radians: to the right of straight ahead
  double distance() const;  ///< √(x² + y²)
};

/// One image with what is true of it and what was inferred. All maps have the same number of pixels.
struct EvaluatedImage {
  std::span<const std::int32_t> true_labels;       ///< 0 background, 1.. objects; may be empty
  std::span<const std::int32_t> predicted_labels;  ///< slot with the largest mask; background is a slot as well
  std::span<const float> true_depth;  ///< may be empty; what is not above 0 and finite (sky) is left out
  std::span<const float> predicted_depth;
  std::span<const LabelledLocation> true_objects;       ///< may be empty
  std::span<const LabelledLocation> predicted_objects;  ///< without background
};

/// Above it an object counts as found.
inline constexpr double kGoodIou = 0.5;

/// An object with the slot that it was matched with, where both have places.
struct MatchedObject {
  LabelledLocation truth, predicted;
  double iou;
};

/// Of the objects in `matches` (match_entities) those that are matched with a slot other than background.
std::vector<MatchedObject> matched_objects(const EvaluatedImage& image, std::span<const Match> matches);

/// A score by the name that people read.
struct NamedScore {
  std::string name;
  std::optional<double> value;
};

/// Collects the scores of section 10 of the model's description over many images.
///
/// ARI and IoU are means over images; an image without foreground is left out of ARI (and of the IoU of
/// objects) and counted as skipped. The depth correlation is the mean over images of each image's own; beside
/// it stands that of all pixels together. Angles atan2(x, y) and distances √(x²+y²) are correlated over all
/// visible objects that are matched with a slot other than background, and over those with IoU > 0.5 alone.
class EvaluationScores {
 public:
  void add(const EvaluatedImage& image);

  std::int64_t images() const { return images_; }
  std::int64_t skipped() const { return skipped_; }
  std::int64_t without_masks() const { return without_masks_; }  ///< images whose true labels are unknown
  std::int64_t without_depth() const { return without_depth_; }  ///< or all of the true depth

  std::optional<double> ari_fg() const { return ari_fg_.value(); }
  std::optional<double> ari_fg_multi() const {
    return ari_fg_multi_.value();
  }  ///< images of two objects or more
  std::optional<double> iou() const { return iou_.value(); }
  std::optional<double> iou_objects() const { return iou_objects_.value(); }
  std::optional<double> depth_r() const { return depth_r_.value(); }
  std::optional<double> depth_r_pooled() const { return depth_pooled_.r(); }
  std::optional<double> angle_r() const { return angle_.r(); }
  std::optional<double> distance_r() const { return distance_.r(); }
  std::optional<double> angle_r_good() const { return angle_good_.r(); }
  std::optional<double> distance_r_good() const { return distance_good_.r(); }

  /// Keys named like the functions above; null where a score is undefined.
  Json to_json() const;
  /// The two halves of it.
  Json scores_json() const;
  Json counts_json() const;

  /// The correlations and means above, in their order.
  std::vector<NamedScore> named() const;

  /// What is left out of which scores, a line each.
  std::vector<std::string> left_out() const;

 private:
  class Mean {
   public:
    void add(const std::optional<double>& value);
    std::optional<double> value() const;

   private:
    double sum_ = 0;
    std::int64_t count_ = 0;
  };

  void add_depth(const EvaluatedImage& image);
  void add_locations(const EvaluatedImage& image, std::span<const Match> matches);

  std::int64_t images_ = 0, skipped_ = 0, without_masks_ = 0, without_depth_ = 0, places_ = 0;
  Mean ari_fg_, ari_fg_multi_, iou_, iou_objects_, depth_r_;
  Correlation depth_pooled_, angle_, distance_, angle_good_, distance_good_;
};

/// Scores beside others.
struct ScoreColumn {
  std::string title;  ///< of its column; may be empty where it is the only one
  const EvaluationScores* scores;
};

/// A table of names and values to three places, one a line; "-" where undefined. A column for each, of the same
/// images: how many there were stands in the first alone. Throws std::out_of_range without any column.
std::string score_table(const std::vector<ScoreColumn>& columns);

}  // namespace vkopple
