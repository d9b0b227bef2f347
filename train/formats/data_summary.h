#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "train/formats/scene.h"

namespace vkopple {

/// Least, largest and mean of numbers given one at a time.
class NumberRange {
 public:
  void add(double value) {
    least_ = std::min(least_, value);
    largest_ = std::max(largest_, value);
    sum_ += value;
    ++count_;
  }
  std::uint64_t count() const { return count_; }
  double least() const { return least_; }
  double largest() const { return largest_; }
  double mean() const { return sum_ / static_cast<double>(count_); }

  /// {"min", "max", "mean"}; null where there were no numbers.
  nlohmann::ordered_json to_json() const;
  /// "0.5 to 7, mean 2.1", and the unit; "unknown" where there were no numbers.
  std::string to_text(const std::string& unit = "") const;

 private:
  double least_ = std::numeric_limits<double>::infinity(), largest_ = -least_, sum_ = 0;
  std::uint64_t count_ = 0;
};

/// What a data set holds, and what speaks against training on it.
class DataSummary {
 public:
  void add(const SceneData& scene);

  std::vector<std::string> warnings() const;
  /// Lengths in scene units, angles in degrees. Steps and turns are those from frame to frame.
  nlohmann::ordered_json to_json() const;
  std::string to_text() const;

 private:
  void add_frame(const SceneFrame& frame);
  void add_step(const CameraPose& from, const CameraPose& to);
  void add_depth(const Plane<float>& depth);

  std::uint64_t scenes_ = 0, all_frames_ = 0, triplets_ = 0, short_scenes_ = 0, still_scenes_ = 0;
  std::uint64_t without_camera_ = 0, with_depth_ = 0, with_labels_ = 0, with_objects_ = 0;
  std::uint64_t depth_pixels_ = 0, unknown_depth_ = 0, saturated_depth_ = 0;
  std::map<std::pair<int, int>, std::uint64_t> sizes_;  ///< frames by width and height
  NumberRange frames_, fov_, depth_, step_, turn_, height_, pitch_, roll_, objects_, object_share_;
};

}  // namespace vkopple
