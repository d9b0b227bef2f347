#include "train/report/svg_plot.h"

#include <gtest/gtest.h>

#include <numbers>

#include "train/report/polar_plot.h"
#include "train/report/top_view.h"

namespace vkopple {
namespace {

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

SvgPlot plot() {
  return {Axis::linear(0, 60, 4),
          Axis::linear(0, 2, 2),
          {.title = "loss <1>", .x_title = "step", .width = 264, .height = 158}};
}

TEST(SvgPlot, ValuesGoToTheirPlaces) {
  const SvgPlot p = plot();  // 46 + 200 + 18 across, 24 + 100 + 34 down
  EXPECT_DOUBLE_EQ(p.x(0), 46);
  EXPECT_DOUBLE_EQ(p.x(30), 146);
  EXPECT_DOUBLE_EQ(p.x(60), 246);
  EXPECT_DOUBLE_EQ(p.y(0), 124);
  EXPECT_DOUBLE_EQ(p.y(2), 24);
  EXPECT_DOUBLE_EQ(p.y(1), 74);
}

TEST(SvgPlot, DrawsWhatItIsTold) {
  SvgPlot p = plot();
  p.line({{0, 0}, {30, 1}}, "line");
  p.area({{0, 2}, {60, 2}, {60, 0}}, "band");
  p.dot({60, 2}, 2.5, "dot");
  p.upright(15, "a & b", 1);
  const std::string svg = p.svg("says \"it\"");
  EXPECT_TRUE(holds(svg, R"(<polyline class="line" points="46.0,124.0 146.0,74.0"/>)")) << svg;
  EXPECT_TRUE(holds(svg, R"(<polygon class="band" points="46.0,24.0 246.0,24.0 246.0,124.0"/>)")) << svg;
  EXPECT_TRUE(holds(svg, R"(<circle class="dot" cx="246.0" cy="24.0" r="2.5"/>)")) << svg;
  EXPECT_TRUE(holds(svg, R"(<line class="dashed" x1="96.0" x2="96.0" y1="24" y2="124.0"/>)")) << svg;
  EXPECT_TRUE(holds(svg, "<text x=\"100.0\" y=\"48\" text-anchor=\"start\">a &amp; b</text>")) << svg;
  EXPECT_TRUE(holds(svg, "loss &lt;1&gt;</text>")) << svg;
  EXPECT_TRUE(holds(svg, "aria-label=\"says &quot;it&quot;\"")) << svg;
  EXPECT_TRUE(holds(svg, R"(viewBox="0 0 264 158")")) << svg;
}

TEST(SvgPlot, TheSameScaleAlongBothAxes) {
  const SvgPlot p(Axis::linear(-3, 3, 6), Axis::linear(0, 6, 6), {.same_scale = true});
  EXPECT_NEAR(p.x(1) - p.x(0), p.y(0) - p.y(1), 1e-9);
}

TEST(PolarPlot, GrowsCounterClockwiseFromTheTop) {
  const std::vector<double> quarters{0.4, 0.2, 0.4, 0};  // ahead, left, back, right
  const std::string svg = polar_plot(quarters, std::numbers::pi / 2, "yaw");
  EXPECT_TRUE(holds(svg, R"(class="line" points="85.0,19.0 52.0,85.0 85.0,151.0 85.0,85.0")")) << svg;
  EXPECT_TRUE(holds(svg, R"(<line class="mark" x1="19.0" y1="85.0" x2="7.0" y2="85.0"/>)")) << svg;
  EXPECT_TRUE(holds(svg, R"(<circle class="dashed" cx="85" cy="85" r="41.2"/>)")) << svg;  // 66 · 0.25 / 0.4
  EXPECT_FALSE(holds(polar_plot(quarters, std::nullopt, "yaw"), "mark"));
}

TEST(TopView, ShowsPairsAndWhatIsAlone) {
  const std::vector<PlacedPair> pairs{
      {PlotPoint{-1, 2}, PlotPoint{1, 3}, true}, {PlotPoint{0, 1}, {}, false}, {{}, PlotPoint{0.5, 4}, false}};
  TopViewReach reach;
  reach.hold(pairs);
  EXPECT_EQ(reach.side, 2);
  EXPECT_EQ(reach.ahead, 4);
  EXPECT_EQ(reach.behind, 0);
  const std::string svg = top_view(pairs, reach, std::numbers::pi / 4, "places");
  const auto count = [&](const std::string& part) {
    int n = 0;
    for (size_t at = svg.find(part); at != std::string::npos; at = svg.find(part, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("class=\"ring\""), 2);
  EXPECT_EQ(count("class=\"dot\""), 1);
  EXPECT_EQ(count("class=\"faint\""), 1);
  EXPECT_EQ(count("class=\"link\""), 1);
  // 276 pixels across for 4 units from -2 on, 69 each.
  EXPECT_TRUE(holds(svg, R"(class="ring" cx="115.0")")) << svg;
  EXPECT_TRUE(holds(svg, R"(class="dot" cx="253.0")")) << svg;
}

TEST(TopView, PlacesBehindTheCameraAreHeldToo) {
  TopViewReach reach;
  reach.hold({{{}, PlotPoint{-3, -1}, false}});
  EXPECT_EQ(reach.side, 3);
  EXPECT_EQ(reach.behind, -1);
}

}  // namespace
}  // namespace vkopple
