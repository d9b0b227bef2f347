#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "models/perception.h"
#include "train/baselines/baselines.h"
#include "train/data/triplets.h"
#include "train/evaluation_scores.h"
#include "train/image.h"

namespace vkopple {

/// Index of the largest of the K+1 masks at each pixel (K is the background). masks: (K+1, H, W) of one image.
std::vector<int32_t> mask_indices(std::span<const float> masks, int64_t entities);

/// An image of a batch with what the model sees in it, as it is scored. Holds while it is looked at.
struct ScoredImage {
  const TripletBatch& batch;
  size_t index;              ///< in the batch
  const Percepts& percepts;  ///< of the whole batch
  const EvaluatedImage& compared;
};

struct EvaluateOptions {
  /// Receives, for the first `grid_rows` images, picture, inferred objects, true objects, inferred depth, true
  /// depth.
  std::vector<std::vector<RgbImage>>* grid = nullptr;
  size_t grid_rows = 6;
  Baselines* baselines = nullptr;                     ///< to score on the same images
  std::function<void(int64_t)> progress = {};         ///< is told how many images are done
  std::function<void(const ScoredImage&)> look = {};  ///< is shown each
};

/// Scores (docs/model.md §10) on the middle frames of a source's triplets, `images` of them from step 0 on.
/// What is unknown of an image is left out of its scores. Throws Error where the first batch has neither labels
/// nor depth.
EvaluationScores evaluate(Perception& model, TripletSource& source, int64_t images,
                          const EvaluateOptions& options = {});

/// The baselines alone.
void evaluate_baselines(Baselines& baselines, TripletSource& source, int64_t images,
                        const std::function<void(int64_t)>& progress = {});

}  // namespace vkopple
