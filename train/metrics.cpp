#include "train/metrics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr std::size_t kMaxLabels = 4096;

using Labels = std::span<const std::int32_t>;

std::vector<std::int32_t> different(Labels labels) {
  std::vector<std::int32_t> found;
  for (const std::int32_t label : labels) {
    const auto place = std::lower_bound(found.begin(), found.end(), label);
    if (place != found.end() && *place == label) continue;
    if (found.size() == kMaxLabels)
      throw Error(fmt::format("a label map holds more than {} labels", kMaxLabels));
    found.insert(place, label);
  }
  return found;
}

/// counts[i][j]: pixels with the i-th true and the j-th predicted label (both sorted), of those that `keep`
/// accepts.
struct Contingency {
  std::vector<std::int32_t> rows, columns;
  std::vector<std::int64_t> counts;

  template <class Keep>
  Contingency(Labels truth, Labels predicted, Keep keep) {
    if (truth.size() != predicted.size() || truth.empty()) {
      throw Error(
          fmt::format("label maps of {} and {} pixels can't be compared", truth.size(), predicted.size()));
    }
    rows = different(truth);
    columns = different(predicted);
    counts.resize(rows.size() * columns.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (keep(truth[i])) ++counts[index(rows, truth[i]) * columns.size() + index(columns, predicted[i])];
    }
  }

  std::int64_t at(std::size_t row, std::size_t column) const { return counts[row * columns.size() + column]; }

  std::vector<std::int64_t> row_sums() const {
    std::vector<std::int64_t> sums(rows.size());
    for (std::size_t i = 0; i < counts.size(); ++i) sums[i / columns.size()] += counts[i];
    return sums;
  }
  std::vector<std::int64_t> column_sums() const {
    std::vector<std::int64_t> sums(columns.size());
    for (std::size_t i = 0; i < counts.size(); ++i) sums[i % columns.size()] += counts[i];
    return sums;
  }

 private:
  static std::size_t index(const std::vector<std::int32_t>& sorted, std::int32_t label) {
    return static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), label) - sorted.begin());
  }
};

/// Pairs of pixels of which both lie in the same cell.
double pairs_within(const std::vector<std::int64_t>& sizes) {
  double pairs = 0;
  for (const std::int64_t n : sizes) pairs += 0.5 * static_cast<double>(n) * static_cast<double>(n - 1);
  return pairs;
}

std::optional<double> mean(double sum, std::size_t count) {
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

}  // namespace

std::size_t object_count(Labels truth) {
  const auto labels = different(truth);
  return static_cast<std::size_t>(
      std::count_if(labels.begin(), labels.end(), [](std::int32_t l) { return l > 0; }));
}

std::optional<double> ari_foreground(Labels truth, Labels predicted) {
  const Contingency table(truth, predicted, [](std::int32_t label) { return label > 0; });
  const auto pixels = std::accumulate(table.counts.begin(), table.counts.end(), std::int64_t{0});
  if (pixels == 0) return std::nullopt;
  const double both = pairs_within(table.counts);  // pairs together in truth and prediction
  const double in_truth = pairs_within(table.row_sums());
  const double in_prediction = pairs_within(table.column_sums());
  if (both == in_truth && both == in_prediction)
    return 1.0;  // the same partition, also where the formula has 0/0
  const double expected = in_truth * in_prediction / pairs_within({pixels});
  return (both - expected) / (0.5 * (in_truth + in_prediction) - expected);
}

std::vector<Match> match_entities(Labels truth, Labels predicted) {
  const Contingency table(truth, predicted, [](std::int32_t) { return true; });
  const auto row_sums = table.row_sums(), column_sums = table.column_sums();
  struct Candidate {
    std::size_t row, column;
    double iou;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    for (std::size_t j = 0; j < table.columns.size(); ++j) {
      const std::int64_t common = table.at(i, j);
      const auto all = static_cast<double>(row_sums[i] + column_sums[j] - common);
      if (common > 0) candidates.push_back({i, j, static_cast<double>(common) / all});
    }
  }
  // Stable: candidates stand row by row, which is the order among equals.
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.iou > b.iou; });
  std::vector<Match> matches;
  for (const std::int32_t label : table.rows) matches.push_back({label, std::nullopt, 0});
  std::vector<bool> taken(table.columns.size());
  for (const Candidate& c : candidates) {
    if (matches[c.row].predicted_label || taken[c.column]) continue;
    matches[c.row] = {table.rows[c.row], table.columns[c.column], c.iou};
    taken[c.column] = true;
  }
  return matches;
}

std::optional<double> mean_iou(std::span<const Match> matches) {
  double sum = 0;
  for (const Match& match : matches) sum += match.iou;
  return mean(sum, matches.size());
}

std::optional<double> mean_iou_objects(std::span<const Match> matches) {
  double sum = 0;
  std::size_t count = 0;
  for (const Match& match : matches) {
    if (match.true_label <= 0) continue;
    sum += match.iou;
    ++count;
  }
  return mean(sum, count);
}

void Correlation::add(double x, double y) {
  ++count_;
  const double share = 1.0 / static_cast<double>(count_);
  const double dx = x - mean_x_, dy = y - mean_y_;
  mean_x_ += dx * share;
  mean_y_ += dy * share;
  sum_xx_ += dx * (x - mean_x_);
  sum_yy_ += dy * (y - mean_y_);
  sum_xy_ += dx * (y - mean_y_);
}

std::optional<double> Correlation::r() const {
  const double product = std::sqrt(sum_xx_) * std::sqrt(sum_yy_);
  if (count_ < 2 || !(product > 0) || !std::isfinite(sum_xy_ / product)) return std::nullopt;
  return std::clamp(sum_xy_ / product, -1.0, 1.0);
}

}  // namespace vkopple
