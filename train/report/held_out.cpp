#include "train/report/held_out.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "train/baselines/baselines.h"
#include "train/evaluate.h"
#include "train/metrics.h"
#include "train/require_numbers.h"

namespace vkopple {
namespace {

/// Triplet `index` of a batch, `each` numbers of it.
std::span<const float> part(const std::vector<float>& values, std::size_t index, std::size_t each) {
  return std::span(values).subspan(index * each, each);
}

TripletFrames frames_of(const TripletBatch& batch, std::size_t index) {
  TripletFrames triplet;
  for (std::size_t f = 0; f < 3; ++f) {
    RgbImage& image = triplet.frames[f] = RgbImage(batch.height, batch.width);
    const auto pixels = part(batch.images[f], index, image.pixels.size());
    std::copy(pixels.begin(), pixels.end(), image.pixels.begin());
    const auto pose = part(batch.poses[f], index, triplet.poses[f].size());
    std::copy(pose.begin(), pose.end(), triplet.poses[f].begin());
  }
  return triplet;
}

/// Keeps what is shown of each image that is scored.
class Collection {
 public:
  Collection(HeldOut& kept, const HeldOutLimits& limits, std::size_t slots)
      : kept_(&kept), limits_(limits), slots_(slots) {}

  void look(const ScoredImage& image) {
    if (kept_->triplets.size() < limits_.triplets && !image.batch.poses[0].empty())
      kept_->triplets.push_back(frames_of(image.batch, image.index));
    const bool in_grid = seen_++ < limits_.rows;
    if (image.percepts.location.empty() || image.compared.true_labels.empty()) {
      if (in_grid) kept_->from_above.emplace_back();
      return;
    }
    require_numbers(image.percepts.location);
    require_numbers(image.percepts.log_pose);
    const auto matched = matched_objects(
        image.compared, match_entities(image.compared.true_labels, image.compared.predicted_labels));
    kept_->matched.insert(kept_->matched.end(), matched.begin(), matched.end());
    if (!in_grid) return;
    kept_->from_above.push_back(places(image.compared, matched));
    for (const MatchedObject& object : matched) add_yaw(image, object);
  }

 private:
  static std::vector<PlacedPair> places(const EvaluatedImage& image,
                                        const std::vector<MatchedObject>& matched) {
    std::vector<PlacedPair> pairs;
    for (const auto& [truth, inferred, iou] : matched)
      pairs.push_back({PlotPoint{truth.x, truth.y}, PlotPoint{inferred.x, inferred.y}, iou > kGoodIou});
    const auto is_matched = [&](const LabelledLocation& place, LabelledLocation MatchedObject::*side) {
      return std::any_of(matched.begin(), matched.end(),
                         [&](const MatchedObject& m) { return (m.*side).label == place.label; });
    };
    for (const LabelledLocation& place : image.true_objects)
      if (!is_matched(place, &MatchedObject::truth)) pairs.push_back({PlotPoint{place.x, place.y}, {}, false});
    for (const LabelledLocation& place : image.predicted_objects)
      if (!is_matched(place, &MatchedObject::predicted))
        pairs.push_back({{}, PlotPoint{place.x, place.y}, false});
    return pairs;
  }

  void add_yaw(const ScoredImage& image, const MatchedObject& object) {
    if (image.percepts.log_pose.empty() || kept_->yaws.size() == limits_.yaws) return;
    const std::size_t bins =
        image.percepts.log_pose.size() / (static_cast<std::size_t>(image.batch.batch) * slots_);
    const auto slot = static_cast<std::size_t>(object.predicted.label);
    SeenYaw yaw{seen_ - 1, object.predicted.label, object.iou, {}, {}};
    for (const float log_probability : part(image.percepts.log_pose, image.index * slots_ + slot, bins))
      yaw.probabilities.push_back(std::exp(double{log_probability}));
    yaw.truth = image.batch.objects[image.index][static_cast<std::size_t>(object.truth.label) - 1].yaw;
    kept_->yaws.push_back(std::move(yaw));
  }

  HeldOut* kept_;
  HeldOutLimits limits_;
  std::size_t slots_, seen_ = 0;
};

}  // namespace

HeldOut look_at_held_out(Perception& model, TripletSource& source, int64_t images, const HeldOutLimits& limits,
                         const std::function<void(int64_t)>& progress) {
  HeldOut kept;
  Collection collection(kept, limits, static_cast<std::size_t>(model.config().slots));
  Baselines baselines(model.config().slots);
  kept.scores = evaluate(model, source, images,
                         {.grid = &kept.grid,
                          .grid_rows = limits.rows,
                          .baselines = &baselines,
                          .progress = progress,
                          .look = [&](const ScoredImage& image) { collection.look(image); }});
  for (const ScoreColumn& column : baselines.columns())
    kept.baselines.push_back({column.title, column.scores->named()});
  return kept;
}

}  // namespace vkopple
