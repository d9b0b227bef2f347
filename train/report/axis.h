#pragma once

#include <string>
#include <utility>
#include <vector>

namespace vkopple {

/// A range of values along a side of a plot, with the values that are written beside it. All of them are
/// finite, `low` is less than `high`, and both above 0 where it is logarithmic.
class Axis {
 public:
  /// Holds low to high and begins and ends with a round number; about `wanted` of them lie on it. Anything
  /// finite, in any order.
  static Axis linear(double low, double high, int wanted = 5);
  /// From low to high, and the round numbers that lie between; for low below high.
  static Axis within(double low, double high, int wanted = 5);
  /// Holds low to high and begins and ends with 1, 2 or 5 times a power of ten; for values above 0.
  static Axis logarithmic(double low, double high);
  /// Logarithmic where all values are above 0 and the largest is many times the least.
  static Axis fitting(double low, double high);

  double low() const { return low_; }
  double high() const { return high_; }
  bool is_logarithmic() const { return logarithmic_; }
  const std::vector<double>& ticks() const { return ticks_; }

  /// Where a value lies, from 0 at `low` to 1 at `high`; others beyond.
  double place(double value) const;
  /// A tick's number, as short as tells it from the others.
  std::string label(double tick) const;

 private:
  /// From the first tick to the last.
  Axis(std::vector<double> ticks, bool logarithmic)
      : low_(ticks.front()), high_(ticks.back()), ticks_(std::move(ticks)), logarithmic_(logarithmic) {}

  double low_, high_;
  std::vector<double> ticks_;
  bool logarithmic_;
};

}  // namespace vkopple
