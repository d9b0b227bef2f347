#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "train/evaluation_scores.h"
#include "train/image_truth.h"
#include "train/json_io.h"

namespace vkopple {

/// Scores of what needs no learning, to see a model's beside:
///
/// - "background": every pixel is background;
/// - "one object": every pixel is of one object;
/// - "random": every pixel of a random slot or background, the same for the same image number;
/// - "k-means": clusters of colour and place (k_means.h), as many as slots and background;
/// - "truth": the true masks, depth and places, which bounds what can be had: of more objects than slots the
///   largest are kept (of equal ones those with the smaller label), the others are background.
///
/// The first four know nothing of depth and places.
class Baselines {
 public:
  /// slots: of the model that they stand beside, without background.
  explicit Baselines(std::int64_t slots);

  void add(const ImageTruth& truth);

  /// In the order above; valid as long as this is.
  std::vector<ScoreColumn> columns() const;
  const EvaluationScores& truth() const { return scores_[kTruth]; }
  /// Scores by name, in which words are joined by "_".
  Json to_json() const;

 private:
  enum Kind : std::size_t { kBackground, kOneObject, kRandom, kKMeans, kTruth, kKinds };

  std::vector<std::int32_t> random_labels(std::size_t pixels) const;
  void add_labels(Kind kind, const ImageTruth& truth, const std::vector<std::int32_t>& predicted);
  void add_truth(const ImageTruth& truth);

  std::int32_t slots_;
  std::array<EvaluationScores, kKinds> scores_;
};

}  // namespace vkopple
