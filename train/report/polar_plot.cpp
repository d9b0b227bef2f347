#include "train/report/polar_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "train/report/html.h"

namespace vkopple {
namespace {

constexpr double kSide = 170, kMiddle = kSide / 2, kRim = 66;
constexpr double kMarkLength = 12;

struct Point {
  double x, y;
};

Point at(double angle, double radius) {
  return {kMiddle - radius * std::sin(angle), kMiddle - radius * std::cos(angle)};
}

std::string circle(double radius, std::string_view css) {
  return fmt::format("<circle class=\"{}\" cx=\"{}\" cy=\"{}\" r=\"{:.1f}\"/>\n", css, kMiddle, kMiddle,
                     radius);
}

std::string spoke(double angle, double from, double to, std::string_view css) {
  const Point a = at(angle, from), b = at(angle, to);
  return fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", css, a.x,
                     a.y, b.x, b.y);
}

}  // namespace

std::string polar_plot(std::span<const double> probabilities, std::optional<double> mark,
                       std::string_view text) {
  const double largest = *std::max_element(probabilities.begin(), probabilities.end());
  const auto bins = static_cast<double>(probabilities.size());
  std::string points;
  for (std::size_t m = 0; m < probabilities.size(); ++m) {
    const Point p = at(2 * std::numbers::pi * static_cast<double>(m) / bins, kRim * probabilities[m] / largest);
    points += fmt::format("{}{:.1f},{:.1f}", m == 0 ? "" : " ", p.x, p.y);
  }
  std::string drawn = circle(kRim, "guide");
  for (int quarter = 0; quarter < 4; ++quarter)
    drawn += spoke(quarter * std::numbers::pi / 2, 0, kRim, "guide");
  drawn += circle(kRim / (bins * largest), "dashed");
  drawn += fmt::format("<polygon class=\"band\" points=\"{0}\"/>\n<polygon class=\"line\" points=\"{0}\"/>\n",
                       points);
  if (mark) drawn += spoke(*mark, kRim, kRim + kMarkLength, "mark");
  return fmt::format("<svg viewBox=\"0 0 {0} {0}\" role=\"img\" aria-label=\"{1}\">\n{2}</svg>", kSide,
                     escape_html(text), drawn);
}

}  // namespace vkopple
