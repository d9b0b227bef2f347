#include "train/evaluate.h"

#include <algorithm>
#include <limits>

#include "runtime/error.h"
#include "train/pictures.h"

namespace vkopple {
namespace {

template <class T>
std::span<const T> part(const std::vector<T>& values, size_t index, size_t count) {
  if (values.empty()) return {};
  return std::span(values).subspan(index * (values.size() / count), values.size() / count);
}

/// Empty where unknown.
std::vector<int32_t> true_labels(const TripletBatch& batch, size_t index) {
  const auto truth = part(batch.label, index, static_cast<size_t>(batch.batch));
  if (truth.empty() || truth[0] == kUnknownLabel) return {};
  return {truth.begin(), truth.end()};
}

std::vector<LabelledLocation> true_locations(const TripletBatch& batch, size_t index) {
  std::vector<LabelledLocation> all;
  if (batch.objects.empty()) return all;
  const auto& objects = batch.objects[index];
  for (size_t i = 0; i < objects.size(); ++i)
    if (objects[i].pixels > 0)
      all.push_back({static_cast<int32_t>(i + 1), objects[i].location[0], objects[i].location[1]});
  return all;
}

std::vector<LabelledLocation> inferred_locations(std::span<const float> location) {
  std::vector<LabelledLocation> all;
  for (size_t k = 0; k * 3 < location.size(); ++k)
    all.push_back({static_cast<int32_t>(k), static_cast<double>(location[3 * k]),
                   static_cast<double>(location[3 * k + 1])});
  return all;
}

/// Endlessly far where there are no values, or 0.
Plane<float> plane(std::span<const float> values, int height, int width) {
  Plane<float> out(height, width);
  std::fill(out.pixels.begin(), out.pixels.end(), std::numeric_limits<float>::infinity());
  std::replace_copy(values.begin(), values.end(), out.pixels.begin(), 0.0f,
                    std::numeric_limits<float>::infinity());
  return out;
}

class Evaluation {
 public:
  Evaluation(Perception& model, std::vector<std::vector<RgbImage>>* grid, size_t grid_rows,
             const std::function<void(const ScoredImage&)>& look)
      : model_(model), grid_(grid), grid_rows_(grid_rows), look_(look) {}

  void add(const TripletBatch& batch, size_t index) {
    const auto count = static_cast<size_t>(batch.batch);
    const auto entities = model_.config().slots + 1;
    const bool has_masks = !percepts_.masks.empty();
    const std::vector<int32_t> labels = has_masks ? true_labels(batch, index) : std::vector<int32_t>{};
    const bool has_depth = !batch.depth.empty();
    const auto inferred = mask_indices(part(percepts_.masks, index, count), entities);
    const auto true_objects = has_masks ? true_locations(batch, index) : std::vector<LabelledLocation>{};
    const auto objects = inferred_locations(part(percepts_.location, index, count));
    const EvaluatedImage image{
        .true_labels = labels,
        .predicted_labels = inferred,
        .true_depth = part(batch.depth, index, count),
        .predicted_depth = has_depth ? part(percepts_.depth, index, count) : std::span<const float>{},
        .true_objects = true_objects,
        .predicted_objects = objects};
    scores_.add(image);
    if (look_) look_({batch, index, percepts_, image});
    if (grid_ != nullptr && grid_->size() < grid_rows_) add_row(batch, index, inferred, labels);
  }

  void see(const TripletBatch& batch) { percepts_ = model_.see(batch.images[1]); }
  EvaluationScores& scores() { return scores_; }

 private:
  void add_row(const TripletBatch& batch, size_t index, std::vector<int32_t> inferred,
               std::vector<int32_t> labels) {
    const auto count = static_cast<size_t>(batch.batch);
    RgbImage image(batch.height, batch.width);
    const auto pixels = part(batch.images[1], index, count);
    std::copy(pixels.begin(), pixels.end(), image.pixels.begin());
    for (int32_t& label : labels) --label;  // objects count from 0 in colours, as slots do
    // What is unknown looks like background, and so does what a model of depth alone infers.
    labels.resize(pixels.size() / 3, -1);
    const auto farthest = static_cast<float>(model_.config().max_depth);
    const auto background = static_cast<int32_t>(model_.config().slots);
    inferred.resize(pixels.size() / 3, background);
    const int zoom = zoom_for(batch.height);
    const auto depth = [&](const std::vector<float>& values) {
      return enlarge(depth_picture(plane(part(values, index, count), batch.height, batch.width), farthest),
                     zoom);
    };
    grid_->push_back({enlarge(image, zoom), overlay(image, inferred, background, zoom),
                      overlay(image, labels, -1, zoom), depth(percepts_.depth), depth(batch.depth)});
  }

  Perception& model_;
  std::vector<std::vector<RgbImage>>* grid_;
  size_t grid_rows_;
  const std::function<void(const ScoredImage&)>& look_;
  Percepts percepts_;
  EvaluationScores scores_;
};

}  // namespace

std::vector<int32_t> mask_indices(std::span<const float> masks, int64_t entities) {
  const auto count = static_cast<size_t>(entities);
  const size_t pixels = masks.size() / count;
  std::vector<int32_t> best(pixels, 0);
  for (size_t p = 0; p < pixels; ++p)
    for (size_t e = 1; e < count; ++e)
      if (masks[e * pixels + p] > masks[static_cast<size_t>(best[p]) * pixels + p])
        best[p] = static_cast<int32_t>(e);
  return best;
}

EvaluationScores evaluate(Perception& model, TripletSource& source, int64_t images,
                          std::vector<std::vector<RgbImage>>* grid, size_t grid_rows,
                          const std::function<void(int64_t)>& progress,
                          const std::function<void(const ScoredImage&)>& look) {
  Evaluation evaluation(model, grid, grid_rows, look);
  for (uint64_t step = 0; evaluation.scores().images() < images; ++step) {
    const TripletBatch batch = source.read(step);
    if (step == 0 && batch.label.empty() && batch.depth.empty())
      throw Error(
          "the data has neither true labels nor true depth to compare with; use rooms:SEED or shards of "
          "vkopple "
          "generate");
    if (batch.batch != model.batch()) throw Error("the data's batches don't fit the model's");
    evaluation.see(batch);
    for (size_t i = 0; i < static_cast<size_t>(batch.batch) && evaluation.scores().images() < images; ++i)
      evaluation.add(batch, i);
    if (progress) progress(evaluation.scores().images());
  }
  return evaluation.scores();
}

}  // namespace vkopple
