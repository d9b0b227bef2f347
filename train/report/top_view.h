#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "train/report/svg_plot.h"

namespace vkopple {

/// An object seen from above, in the camera's frame: x right, y forward, scene units.
struct PlacedPair {
  std::optional<PlotPoint> truth, inferred;
  bool good = true;  ///< found well; drawn full
};

/// How far a view reaches from the camera, in scene units.
struct TopViewReach {
  double side = 2, ahead = 2, behind = 0;

  /// Widens it to hold all that is known of the pairs.
  void hold(const std::vector<PlacedPair>& pairs);
};

/// Where objects are and where they are inferred to be, as inline SVG: true places as rings, inferred ones as
/// dots, a line between the two of an object; the camera below in the middle with the borders of its view.
/// `half_view`: half the horizontal angle of view, radians. `text` says what it shows to those who don't see
/// it.
std::string top_view(const std::vector<PlacedPair>& pairs, const TopViewReach& reach, double half_view,
                     std::string_view text);

}  // namespace vkopple
