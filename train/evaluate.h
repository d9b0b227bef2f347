#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "models/perception.h"
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

/// Scores (docs/model.md §10) on the middle frames of a source's triplets, `images` of them from step 0 on.
/// What is unknown of an image is left out of its scores. Where `grid` is given it receives, for the first
/// `grid_rows` images, picture, inferred objects, true objects, inferred depth, true depth. `progress` is told
/// how many images are done, `look` is shown each; both may be empty. Throws Error where the first batch has
/// neither labels nor depth.
EvaluationScores evaluate(Perception& model, TripletSource& source, int64_t images,
                          std::vector<std::vector<RgbImage>>* grid = nullptr, size_t grid_rows = 6,
                          const std::function<void(int64_t)>& progress = {},
                          const std::function<void(const ScoredImage&)>& look = {});

}  // namespace vkopple
