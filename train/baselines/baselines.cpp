#include "train/baselines/baselines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "train/baselines/k_means.h"
#include "train/random.h"

namespace vkopple {
namespace {

constexpr std::uint64_t kRandomSeed = 1;

/// The slot of each true label. Background and what no slot is left for: `slots`.
std::map<std::int32_t, std::int32_t> slots_of_labels(const std::vector<std::int32_t>& labels,
                                                     std::int32_t slots) {
  std::map<std::int32_t, std::int64_t> pixels;
  for (const std::int32_t label : labels) ++pixels[label];
  std::map<std::int32_t, std::int32_t> slot_of;
  std::vector<std::pair<std::int64_t, std::int32_t>> objects;
  for (const auto& [label, count] : pixels) {
    slot_of[label] = slots;
    if (label > 0) objects.emplace_back(-count, label);
  }
  std::sort(objects.begin(), objects.end());
  const auto kept = std::min(objects.size(), static_cast<std::size_t>(slots));
  for (std::size_t i = 0; i < kept; ++i) slot_of[objects[i].second] = static_cast<std::int32_t>(i);
  return slot_of;
}

}  // namespace

Baselines::Baselines(std::int64_t slots) : slots_(static_cast<std::int32_t>(slots)) {}

std::vector<std::int32_t> Baselines::random_labels(std::size_t pixels) const {
  Random random(kRandomSeed, static_cast<std::uint64_t>(scores_[kRandom].images()));
  std::vector<std::int32_t> labels(pixels);
  for (std::int32_t& label : labels)
    label = static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(slots_) + 1));
  return labels;
}

void Baselines::add_labels(Kind kind, const ImageTruth& truth, const std::vector<std::int32_t>& predicted) {
  scores_[kind].add({.true_labels = truth.labels, .predicted_labels = predicted});
}

void Baselines::add_truth(const ImageTruth& truth) {
  std::map<std::int32_t, std::int32_t> slot_of = slots_of_labels(truth.labels, slots_);
  std::vector<std::int32_t> labels;
  labels.reserve(truth.labels.size());
  for (const std::int32_t label : truth.labels) labels.push_back(slot_of.at(label));
  std::vector<LabelledLocation> places;
  for (const LabelledLocation& object : truth.objects)
    if (const auto found = slot_of.find(object.label); found != slot_of.end() && found->second < slots_)
      places.push_back({found->second, object.x, object.y});
  std::vector<float> depth(truth.depth.begin(), truth.depth.end());
  for (float& d : depth)
    if (!std::isfinite(d)) d = 0;  // sky, which no score counts
  scores_[kTruth].add({.true_labels = truth.labels,
                       .predicted_labels = labels,
                       .true_depth = truth.depth,
                       .predicted_depth = depth,
                       .true_objects = truth.objects,
                       .predicted_objects = places});
}

void Baselines::add(const ImageTruth& truth) {
  const std::size_t pixels = truth.labels.size();
  add_labels(kBackground, truth, std::vector<std::int32_t>(pixels, slots_));
  add_labels(kOneObject, truth, std::vector<std::int32_t>(pixels, 0));
  add_labels(kRandom, truth, random_labels(pixels));
  add_labels(kKMeans, truth,
             pixels == 0 ? std::vector<std::int32_t>{}
                         : k_means_labels(truth.image, truth.height, truth.width, slots_ + 1));
  add_truth(truth);
}

std::vector<ScoreColumn> Baselines::columns() const {
  constexpr std::array<const char*, kKinds> kNames{"background", "one object", "random", "k-means", "truth"};
  std::vector<ScoreColumn> columns;
  for (std::size_t i = 0; i < kKinds; ++i) columns.push_back({kNames[i], &scores_[i]});
  return columns;
}

Json Baselines::to_json() const {
  Json json;
  for (const ScoreColumn& column : columns()) {
    std::string name = column.title;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
    json[name] = column.scores->scores_json();
  }
  return json;
}

}  // namespace vkopple
