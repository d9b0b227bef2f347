#include "train/baselines/k_means.h"

#include <algorithm>
#include <array>
#include <limits>

namespace vkopple {
namespace {

using Feature = std::array<double, 5>;

double squared_distance(const Feature& a, const Feature& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

std::vector<Feature> features_of(std::span<const float> image, int height, int width) {
  const std::size_t area = image.size() / 3;
  const double side = std::max(height, width);
  std::vector<Feature> features;
  features.reserve(area);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const std::size_t p = features.size();
      features.push_back({image[p], image[area + p], image[2 * area + p], column / side, row / side});
    }
  return features;
}

/// The mean of each label's features; `before` where it has none.
std::vector<Feature> means(const std::vector<Feature>& features, const std::vector<std::int32_t>& labels,
                           std::vector<Feature> before) {
  std::vector<Feature> sums(before.size(), Feature{});
  std::vector<double> counts(before.size());
  for (std::size_t p = 0; p < features.size(); ++p) {
    const auto label = static_cast<std::size_t>(labels[p]);
    ++counts[label];
    for (std::size_t i = 0; i < features[p].size(); ++i) sums[label][i] += features[p][i];
  }
  for (std::size_t k = 0; k < before.size(); ++k)
    for (std::size_t i = 0; counts[k] > 0 && i < before[k].size(); ++i) before[k][i] = sums[k][i] / counts[k];
  return before;
}

std::vector<Feature> first_centres(const std::vector<Feature>& features, int clusters) {
  const Feature middle = means(features, std::vector<std::int32_t>(features.size()), {Feature{}})[0];
  std::vector<Feature> centres{
      *std::min_element(features.begin(), features.end(), [&](const Feature& a, const Feature& b) {
        return squared_distance(a, middle) < squared_distance(b, middle);
      })};
  std::vector<double> nearest(features.size(), std::numeric_limits<double>::infinity());
  while (centres.size() < static_cast<std::size_t>(clusters)) {
    for (std::size_t p = 0; p < features.size(); ++p)
      nearest[p] = std::min(nearest[p], squared_distance(features[p], centres.back()));
    centres.push_back(
        features[static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin())]);
  }
  return centres;
}

std::vector<std::int32_t> assigned(const std::vector<Feature>& features, const std::vector<Feature>& centres) {
  std::vector<std::int32_t> labels;
  labels.reserve(features.size());
  for (const Feature& feature : features) {
    const auto nearest =
        std::min_element(centres.begin(), centres.end(), [&](const Feature& a, const Feature& b) {
          return squared_distance(feature, a) < squared_distance(feature, b);
        });
    labels.push_back(static_cast<std::int32_t>(nearest - centres.begin()));
  }
  return labels;
}

/// The label that the most pixels on the border have, of equal ones the first.
std::int32_t border_label(const std::vector<std::int32_t>& labels, int height, int width, int clusters) {
  std::vector<int> counts(static_cast<std::size_t>(clusters));
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const bool inside = row > 0 && row < height - 1 && column > 0 && column < width - 1;
      const auto p =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
      if (!inside) ++counts[static_cast<std::size_t>(labels[p])];
    }
  return static_cast<std::int32_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

}  // namespace

std::vector<std::int32_t> k_means_labels(std::span<const float> image, int height, int width, int clusters) {
  const std::vector<Feature> features = features_of(image, height, width);
  std::vector<Feature> centres = first_centres(features, clusters);
  std::vector<std::int32_t> labels = assigned(features, centres);
  for (int round = 0; round < kKMeansRounds; ++round) {
    centres = means(features, labels, std::move(centres));
    labels = assigned(features, centres);
  }
  const std::int32_t background = border_label(labels, height, width, clusters), last = clusters - 1;
  for (std::int32_t& label : labels) label = label == background ? last : label == last ? background : label;
  return labels;
}

}  // namespace vkopple
