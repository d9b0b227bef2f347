#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "models/perception.h"
#include "train/data/triplets.h"
#include "train/evaluation_scores.h"
#include "train/image.h"
#include "train/predictor.h"
#include "train/report/top_view.h"

namespace vkopple {

/// What a slot that was matched with an object says of its yaw.
struct SeenYaw {
  std::size_t image;  ///< row of the grid
  std::int32_t slot;
  double iou;
  std::vector<double> probabilities;  ///< of the bins
  std::optional<double> truth;        ///< radians
};

/// A triplet to predict the third frame of.
struct TripletFrames {
  std::array<RgbImage, 3> frames;
  std::array<CameraPose, 3> poses;
};

/// What is scored on the same images, by its name.
struct NamedScores {
  std::string name;
  std::vector<NamedScore> scores;
};

/// What a model sees in images that it was not trained on.
struct HeldOut {
  EvaluationScores scores;
  std::vector<NamedScores> baselines;  ///< train/baselines
  /// Of the first images: picture, inferred objects, true objects, inferred depth, true depth.
  std::vector<std::vector<RgbImage>> grid;
  std::vector<std::vector<PlacedPair>> from_above;  ///< of the same: all slots and all objects in sight
  std::vector<MatchedObject> matched;               ///< of all images
  std::vector<SeenYaw> yaws;                        ///< of the first images; none of a model of 3D rotation
  std::vector<TripletFrames> triplets;              ///< the first ones; none where cameras are unknown
};

/// How much of it is kept, beside the scores.
struct HeldOutLimits {
  std::size_t rows = 6;
  std::size_t yaws = 8;
  std::size_t triplets = 4;
};

/// Scores `images` images of a source (evaluate) and keeps what the report shows. `progress` is told how many
/// are done. Throws Error as evaluate does, and where a place or a yaw is no number.
HeldOut look_at_held_out(Perception& model, TripletSource& source, int64_t images, const HeldOutLimits& limits,
                         const std::function<void(int64_t)>& progress);

/// A triplet with its prediction.
struct Prediction {
  TripletFrames truth;
  PredictedFrame predicted;
};

}  // namespace vkopple
