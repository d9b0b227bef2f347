#include "train/evaluate.h"

#include <algorithm>
#include <limits>

#include "runtime/error.h"
#include "train/image_truth.h"
#include "train/pictures.h"

namespace vkopple {
namespace {

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
  Evaluation(Perception& model, const EvaluateOptions& options) : model_(model), options_(options) {}

  void add(const TripletBatch& batch, size_t index) {
    const auto count = static_cast<size_t>(batch.batch);
    const auto entities = model_.config().slots + 1;
    ImageTruth truth = image_truth(batch, index);
    if (options_.baselines != nullptr) options_.baselines->add(truth);
    if (percepts_.masks.empty()) {  // of a model of depth alone nothing else is scored
      truth.labels.clear();
      truth.objects.clear();
    }
    const auto inferred = mask_indices(equal_part(percepts_.masks, index, count), entities);
    const auto objects = inferred_locations(equal_part(percepts_.location, index, count));
    const bool has_depth = !truth.depth.empty();
    const EvaluatedImage image{
        .true_labels = truth.labels,
        .predicted_labels = inferred,
        .true_depth = truth.depth,
        .predicted_depth = has_depth ? equal_part(percepts_.depth, index, count) : std::span<const float>{},
        .true_objects = truth.objects,
        .predicted_objects = objects};
    scores_.add(image);
    if (options_.look) options_.look({batch, index, percepts_, image});
    if (options_.grid != nullptr && options_.grid->size() < options_.grid_rows)
      add_row(batch, index, inferred, truth.labels);
  }

  void see(const TripletBatch& batch) { percepts_ = model_.see(batch.images[1]); }
  EvaluationScores& scores() { return scores_; }

 private:
  void add_row(const TripletBatch& batch, size_t index, std::vector<int32_t> inferred,
               std::vector<int32_t> labels) {
    const auto count = static_cast<size_t>(batch.batch);
    RgbImage image(batch.height, batch.width);
    const auto pixels = equal_part(batch.images[1], index, count);
    std::copy(pixels.begin(), pixels.end(), image.pixels.begin());
    for (int32_t& label : labels) --label;  // objects count from 0 in colours, as slots do
    // What is unknown looks like background, and so does what a model of depth alone infers.
    labels.resize(pixels.size() / 3, -1);
    const auto farthest = static_cast<float>(model_.config().max_depth);
    const auto background = static_cast<int32_t>(model_.config().slots);
    inferred.resize(pixels.size() / 3, background);
    const int zoom = zoom_for(batch.height);
    const auto depth = [&](const std::vector<float>& values) {
      return enlarge(
          depth_picture(plane(equal_part(values, index, count), batch.height, batch.width), farthest), zoom);
    };
    options_.grid->push_back({enlarge(image, zoom), overlay(image, inferred, background, zoom),
                              overlay(image, labels, -1, zoom), depth(percepts_.depth), depth(batch.depth)});
  }

  Perception& model_;
  const EvaluateOptions& options_;
  Percepts percepts_;
  EvaluationScores scores_;
};

template <class SeeBatch, class AddImage>
void for_each_image(TripletSource& source, int64_t images, const std::function<void(int64_t)>& progress,
                    const SeeBatch& see_batch, const AddImage& add_image) {
  int64_t done = 0;
  for (uint64_t step = 0; done < images; ++step) {
    const TripletBatch batch = source.read(step);
    if (step == 0 && batch.label.empty() && batch.depth.empty())
      throw Error(
          "the data has neither true labels nor true depth to compare with; use rooms:SEED or shards of "
          "vkopple generate");
    see_batch(batch);
    for (size_t i = 0; i < static_cast<size_t>(batch.batch) && done < images; ++i, ++done) add_image(batch, i);
    if (progress) progress(done);
  }
}

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
                          const EvaluateOptions& options) {
  Evaluation evaluation(model, options);
  for_each_image(
      source, images, options.progress,
      [&](const TripletBatch& batch) {
        if (batch.batch != model.batch()) throw Error("the data's batches don't fit the model's");
        evaluation.see(batch);
      },
      [&](const TripletBatch& batch, size_t index) { evaluation.add(batch, index); });
  return evaluation.scores();
}

void evaluate_baselines(Baselines& baselines, TripletSource& source, int64_t images,
                        const std::function<void(int64_t)>& progress) {
  for_each_image(
      source, images, progress, [](const TripletBatch&) {},
      [&](const TripletBatch& batch, size_t index) { baselines.add(image_truth(batch, index)); });
}

}  // namespace vkopple
