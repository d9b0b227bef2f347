#include "train/report/top_view.h"

#include <algorithm>
#include <cmath>

namespace vkopple {
namespace {

/// From the camera along the border of its view up to the plot's.
PlotPoint border(double angle, const Axis& x, const Axis& y) {
  const double side = std::sin(angle), forward = std::cos(angle);
  double length = y.high() / std::max(forward, 1e-6);
  length = std::min(length, x.high() / std::max(std::abs(side), 1e-6));
  return {length * side, length * forward};
}

}  // namespace

void TopViewReach::hold(const std::vector<PlacedPair>& pairs) {
  for (const PlacedPair& pair : pairs)
    for (const std::optional<PlotPoint>& place : {pair.truth, pair.inferred}) {
      if (!place) continue;
      side = std::max(side, std::abs(place->x));
      ahead = std::max(ahead, place->y);
      behind = std::min(behind, place->y);
    }
}

std::string top_view(const std::vector<PlacedPair>& pairs, const TopViewReach& reach, double half_view,
                     std::string_view text) {
  const Axis x = Axis::linear(-reach.side, reach.side, 6), y = Axis::linear(reach.behind, reach.ahead);
  SvgPlot plot(x, y,
               {.title = "y, forward, scene units", .x_title = "x, right, scene units", .same_scale = true});
  for (const double angle : {-half_view, half_view}) plot.line({{0, 0}, border(angle, x, y)}, "dashed");
  const double foot = (x.high() - x.low()) / 50;
  plot.area({{-foot, 0}, {foot, 0}, {0, 2 * foot}}, "camera");
  for (const auto& [truth, inferred, good] : pairs)
    if (truth && inferred) plot.line({*truth, *inferred}, "link");
  for (const auto& [truth, inferred, good] : pairs) {
    if (truth) plot.dot(*truth, 4, "ring");
    if (inferred) plot.dot(*inferred, 2.8, good ? "dot" : "faint");
  }
  return plot.svg(text);
}

}  // namespace vkopple
