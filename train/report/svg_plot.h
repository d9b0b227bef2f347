#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "train/report/axis.h"

namespace vkopple {

struct PlotPoint {
  double x, y;
};

/// A plot as inline SVG, its colours those of the page's style. Values go by two axes; lengths and coordinates
/// of the picture are in its own pixels, from the top left.
class SvgPlot {
 public:
  struct Look {
    std::string title;    ///< what the vertical axis shows, written above it
    std::string x_title;  ///< likewise of the horizontal axis, below it
    double width = 340;   ///< of the whole picture
    double height = 210;
    bool same_scale = false;  ///< one unit is as long along both axes; `height` follows
  };

  SvgPlot(Axis x, Axis y, Look look);

  double x(double value) const;
  double y(double value) const;

  /// `css`: classes of the page's style.
  void line(const std::vector<PlotPoint>& points, std::string_view css);
  void dot(PlotPoint at, double radius, std::string_view css);
  /// A closed shape.
  void area(const std::vector<PlotPoint>& points, std::string_view css);
  /// A dashed line over the whole height with a word beside it, in a line of words counted from the top.
  void upright(double at, std::string_view text, int line = 0);

  /// `text` says what it shows to those who don't see it.
  std::string svg(std::string_view text) const;

 private:
  std::string grid() const;
  std::string coordinates(const std::vector<PlotPoint>& points) const;

  Axis x_, y_;
  Look look_;
  std::string drawn_;
};

}  // namespace vkopple
