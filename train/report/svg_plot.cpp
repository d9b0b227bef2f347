#include "train/report/svg_plot.h"

#include <fmt/format.h>

#include <utility>

#include "train/report/html.h"

namespace vkopple {
namespace {

constexpr double kLine = 13;                                        // of words
constexpr double kLeft = 46, kRight = 18, kTop = 24, kBottom = 34;  // margins around what the axes span

}  // namespace

SvgPlot::SvgPlot(Axis x, Axis y, Look look) : x_(std::move(x)), y_(std::move(y)), look_(std::move(look)) {
  if (look_.same_scale)
    look_.height =
        kTop + kBottom + (look_.width - kLeft - kRight) * (y_.high() - y_.low()) / (x_.high() - x_.low());
}

double SvgPlot::x(double value) const { return kLeft + (look_.width - kLeft - kRight) * x_.place(value); }

double SvgPlot::y(double value) const {
  return look_.height - kBottom - (look_.height - kTop - kBottom) * y_.place(value);
}

std::string SvgPlot::coordinates(const std::vector<PlotPoint>& points) const {
  std::string text;
  for (const auto& [px, py] : points)
    text += fmt::format("{}{:.1f},{:.1f}", text.empty() ? "" : " ", x(px), y(py));
  return text;
}

void SvgPlot::line(const std::vector<PlotPoint>& points, std::string_view css) {
  drawn_ += fmt::format("<polyline class=\"{}\" points=\"{}\"/>\n", css, coordinates(points));
}

void SvgPlot::dot(PlotPoint at, double radius, std::string_view css) {
  drawn_ += fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\"/>\n", css, x(at.x),
                        y(at.y), radius);
}

void SvgPlot::area(const std::vector<PlotPoint>& points, std::string_view css) {
  drawn_ += fmt::format("<polygon class=\"{}\" points=\"{}\"/>\n", css, coordinates(points));
}

void SvgPlot::upright(double at, std::string_view text, int line) {
  const double across = x(at);
  const bool right_half = across > look_.width / 2;
  drawn_ += fmt::format(
      "<line class=\"dashed\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2:.1f}\"/>\n"
      "<text x=\"{3:.1f}\" y=\"{4}\" text-anchor=\"{5}\">{6}</text>\n",
      across, kTop, look_.height - kBottom, across + (right_half ? -4 : 4), kTop + 11 + kLine * line,
      right_half ? "end" : "start", escape_html(text));
}

std::string SvgPlot::grid() const {
  std::string out;
  const double left = kLeft, right = look_.width - kRight, bottom = look_.height - kBottom;
  for (const double tick : y_.ticks())
    out += fmt::format(
        "<line class=\"guide\" x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
        "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        left, right, y(tick), left - 6, y(tick) + 4, y_.label(tick));
  for (const double tick : x_.ticks())
    out += fmt::format(
        "<line class=\"guide\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>"
        "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>\n",
        x(tick), bottom, bottom + 4, bottom + 16, x_.label(tick));
  return out;
}

std::string SvgPlot::svg(std::string_view text) const {
  return fmt::format(
      "<svg viewBox=\"0 0 {0:g} {1:.0f}\" role=\"img\" aria-label=\"{2}\">\n{3}{4}"
      "<text class=\"title\" x=\"2\" y=\"13\">{5}</text>\n"
      "<text x=\"{6:.1f}\" y=\"{7:.0f}\" text-anchor=\"end\">{8}</text>\n</svg>",
      look_.width, look_.height, escape_html(text), grid(), drawn_, escape_html(look_.title),
      look_.width - kRight, look_.height - 4, escape_html(look_.x_title));
}

}  // namespace vkopple
