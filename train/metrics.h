#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace vkopple {

// Scores of single images (section 10 of the model's description). A label map holds one label per pixel, row
// by row. True labels: 0 background, 1.. objects. Predicted labels: any; they only say which pixels go
// together. Two maps of different size, an empty one, or one with more than 4096 labels is an Error.

/// Number of different true objects.
std::size_t object_count(std::span<const std::int32_t> truth);

/// Adjusted Rand index over the pixels whose true label is not background; nothing where there is none.
/// Background predicted inside an object is a cluster like any other. With one true object: 1 if predicted as
/// one cluster, else 0.
std::optional<double> ari_foreground(std::span<const std::int32_t> truth,
                                     std::span<const std::int32_t> predicted);

/// A true entity and the predicted one that greedy matching gave it.
struct Match {
  std::int32_t true_label;
  std::optional<std::int32_t> predicted_label;  ///< none where nothing that overlaps it was left
  double iou;                                   ///< 0 where none
};

/// Matches true entities (objects and background) with predicted ones by descending intersection over union; of
/// equal ones the smaller true label goes first, then the smaller predicted. Sorted by true label.
std::vector<Match> match_entities(std::span<const std::int32_t> truth, std::span<const std::int32_t> predicted);

/// Mean IoU of all matches, and of those of objects alone; nothing where there is none.
std::optional<double> mean_iou(std::span<const Match> matches);
std::optional<double> mean_iou_objects(std::span<const Match> matches);

/// Pearson's correlation of pairs given one at a time, with one pass and no cancellation (Welford).
class Correlation {
 public:
  void add(double x, double y);
  std::int64_t count() const { return count_; }

  /// Nothing when undefined: fewer than two pairs, all x or all y equal, or a value that was not finite.
  std::optional<double> r() const;

 private:
  std::int64_t count_ = 0;
  double mean_x_ = 0, mean_y_ = 0, sum_xx_ = 0, sum_yy_ = 0, sum_xy_ = 0;  // sums of squares about the means
};

}  // namespace vkopple
