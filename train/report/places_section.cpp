#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "train/metrics.h"
#include "train/report/html.h"
#include "train/report/report_page.h"

namespace vkopple {
namespace {

constexpr std::size_t kMostFromAbove = 300;  // objects in one plot

constexpr std::string_view kKey =
    R"(<span class="key"><svg viewBox="0 0 20 10" aria-hidden="true"><circle class="ring" cx="10" cy="5" r="4"/></svg> true</span>, )"
    R"(<span class="key"><svg viewBox="0 0 20 10" aria-hidden="true"><circle class="dot" cx="10" cy="5" r="3"/></svg> inferred, IoU &gt; 0.5</span>, )"
    R"(<span class="key"><svg viewBox="0 0 20 10" aria-hidden="true"><circle class="faint" cx="10" cy="5" r="3"/></svg> inferred, less</span>)";

/// True against inferred values of something, in the same unit.
struct Scatter {
  std::string title, unit;
  double (LabelledLocation::*of)() const;
  double scale;
};

std::string scatter_plot(const std::vector<MatchedObject>& objects, const Scatter& shown) {
  const auto value = [&](const LabelledLocation& place) { return shown.scale * (place.*shown.of)(); };
  double low = value(objects[0].truth), high = low;
  Correlation all, good;
  for (const auto& [truth, inferred, iou] : objects) {
    for (const double v : {value(truth), value(inferred)}) {
      low = std::min(low, v);
      high = std::max(high, v);
    }
    all.add(value(truth), value(inferred));
    if (iou > kGoodIou) good.add(value(truth), value(inferred));
  }
  const Axis axis = Axis::linear(low, high, 6);
  SvgPlot plot(axis, axis,
               {.title = fmt::format("inferred {}, {}", shown.title, shown.unit),
                .x_title = fmt::format("true {}, {}", shown.title, shown.unit),
                .same_scale = true});
  plot.line({{axis.low(), axis.low()}, {axis.high(), axis.high()}}, "dashed");
  for (const auto& [truth, inferred, iou] : objects)
    plot.dot({value(truth), value(inferred)}, 2.8, iou > kGoodIou ? "dot" : "faint");
  const auto r = [](const Correlation& c) {
    return c.r() ? fmt::format("r = {:.3f}", *c.r()) : std::string("r is undefined");
  };
  return figure_html(
      plot.svg(fmt::format("Inferred over true {} of matched objects", shown.title)),
      fmt::format(
          "The {} of {} matched objects: {}. Of the {} with IoU &gt; 0.5: {}. Dashed: where both are equal.",
          shown.title, all.count(), r(all), good.count(), r(good)));
}

std::string all_from_above(const Report& report) {
  std::vector<PlacedPair> pairs;
  for (const auto& [truth, inferred, iou] : report.held_out.matched) {
    if (pairs.size() == kMostFromAbove) break;
    pairs.push_back({PlotPoint{truth.x, truth.y}, PlotPoint{inferred.x, inferred.y}, iou > kGoodIou});
  }
  TopViewReach reach;
  reach.hold(pairs);
  return figure_html(
      top_view(pairs, reach, report.half_view, "True and inferred places of matched objects from above"),
      fmt::format("{} of {} matched objects from above, the camera below in the middle, the borders of its "
                  "view dashed: {}. A line joins the two places of an object.",
                  pairs.size(), report.held_out.matched.size(), kKey));
}

std::string each_from_above(const Report& report) {
  const auto& images = report.held_out.from_above;
  TopViewReach reach;
  for (const auto& pairs : images) reach.hold(pairs);
  std::string html;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (!images[i].empty())
      html += figure_html(top_view(images[i], reach, report.half_view,
                                   fmt::format("Places of objects of image {} from above", i + 1)),
                          fmt::format("Image {}", i + 1));
  if (html.empty()) return html;
  return "<h3>The first images one by one</h3>\n<p class=\"quiet\">With the places of all slots and of all "
         "objects in sight; those without a line are matched with nothing.</p>\n<div class=\"plots\">\n" +
         html + "</div>\n";
}

std::string nothing_to_show(const Report& report) {
  if (!report.has_learned(Network::kObject)) return "the object network has not learned yet";
  return "no object whose place is known was matched with a slot";
}

}  // namespace

std::string places_section(const Report& report) {
  const auto& matched = report.held_out.matched;
  const std::string_view heading = "Where it sees objects";
  if (!report.has_learned(Network::kObject) || matched.empty())
    return section_html("places", heading,
                        fmt::format("<p>Nothing to show: {}.</p>\n", nothing_to_show(report)));
  std::string html =
      "<p>Places in the camera’s frame, x to the right and y forward, in scene units. The angle is atan2(x, "
      "y), to the right of straight ahead, the distance √(x² + y²). An object is matched with the slot whose "
      "mask overlaps it most.</p>\n<div class=\"plots\">\n";
  html += all_from_above(report);
  html += scatter_plot(matched, {"angle", "degrees", &LabelledLocation::angle, 180 / std::numbers::pi});
  html += scatter_plot(matched, {"distance", "scene units", &LabelledLocation::distance, 1});
  return section_html("places", heading, html + "</div>\n" + each_from_above(report));
}

}  // namespace vkopple
