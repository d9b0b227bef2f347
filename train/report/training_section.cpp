#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "train/report/html.h"
#include "train/report/report_page.h"

namespace vkopple {
namespace {

constexpr std::size_t kMostStretches = 150;
constexpr std::size_t kMostStageMarks = 6;

std::string loss_title(const std::string& term) {
  static const std::map<std::string, std::string> kTitles{
      {"total", "total loss"},
      {"image", "image, squared colours summed over pixels"},
      {"centre", "centre, scene units²"},
      {"location", "location, scene units²"},
      {"pose", "pose, nats"},
      {"collapse", "collapse, scene units"},
      {"smoothness", "smoothness, squared masks summed over pixels"},
      {"pose_contrast", "pose contrast, nats"},
      {"slot_contrast", "slot contrast, scene units"}};
  const auto found = kTitles.find(term);
  return found == kTitles.end() ? term : found->second;
}

/// Draws curves over the steps of a run.
class Steps {
 public:
  explicit Steps(const Report& report) : report_(&report), curves_(&*report.curves) {
    axis_ = Axis::within(0, std::max(curves_->seconds.back().x, 1.0), 4);
  }

  enum class Kind { kAny, kScore };

  /// Scores are drawn up to 1, which is perfect, with a dot for each.
  std::string plot(const std::string& title, const Curve& curve, Kind kind = Kind::kAny) const {
    const auto parts = stretches(curve, kMostStretches);
    double low = parts[0].low, high = parts[0].high;
    for (const CurveStretch& s : parts) {
      low = std::min(low, s.low);
      high = std::max(high, s.high);
    }
    const Axis y = kind == Kind::kScore ? Axis::linear(std::min(low, 0.0), 1) : Axis::fitting(low, high);
    SvgPlot plot(axis_, y, {.title = title + (y.is_logarithmic() ? ", logarithmic" : ""), .x_title = "step"});
    mark(plot);
    std::vector<PlotPoint> around, line;
    for (const CurveStretch& s : parts) {
      around.push_back({s.x, s.high});
      line.push_back({s.x, s.mean});
    }
    for (auto s = parts.rbegin(); s != parts.rend(); ++s) around.push_back({s->x, s->low});
    if (parts.size() < curve.size()) plot.area(around, "band");
    plot.line(line, "line");
    if (kind == Kind::kScore || line.size() == 1)
      for (const PlotPoint& point : line) plot.dot(point, 2.5, "dot");
    return figure_html(plot.svg(title + " over the steps of training"),
                       fmt::format("{} in the last step", number(curve.back().y)));
  }

 private:
  static std::string number(double value) {
    return fmt::format("{}{:.4g}", value < 0 ? "−" : "", std::abs(value));
  }

  void mark(SvgPlot& plot) const {
    if (curves_->stages.size() > 1 && curves_->stages.size() <= kMostStageMarks)
      for (const StageBegin& stage : curves_->stages) plot.upright(static_cast<double>(stage.step), stage.name);
    const auto here = static_cast<double>(report_->position.step);
    if (here < curves_->seconds.back().x) plot.upright(here, "this model", 1);
  }

  const Report* report_;
  const TrainingCurves* curves_;
  Axis axis_ = Axis::linear(0, 1);
};

/// "total" first, the others by name.
std::vector<std::string> terms(const TrainingCurves& curves) {
  std::vector<std::string> names;
  for (const auto& [name, curve] : curves.losses) names.push_back(name);
  std::stable_partition(names.begin(), names.end(), [](const std::string& name) { return name == "total"; });
  return names;
}

std::string plots(const Report& report) {
  const TrainingCurves& curves = *report.curves;
  const Steps steps(report);
  std::string html = "<h3>Losses</h3>\n<div class=\"plots\">\n";
  for (const std::string& term : terms(curves)) html += steps.plot(loss_title(term), curves.losses.at(term));
  html += "</div>\n";
  if (!curves.held_out.empty()) {
    static const std::map<std::string, std::string> kTitles{
        {"ari_fg", "ARI-fg"}, {"iou", "IoU"}, {"depth_r", "depth r, mean over images"}};
    html += "<h3>Scores in rooms that training never draws</h3>\n<div class=\"plots\">\n";
    for (const auto& [name, curve] : curves.held_out)
      html += steps.plot(kTitles.at(name), curve, Steps::Kind::kScore);
    html += "</div>\n";
  }
  html += "<h3>Time</h3>\n<div class=\"plots\">\n" + steps.plot("seconds a step", curves.seconds) +
          steps.plot("of these until the batch was there, seconds", curves.data_seconds);
  return html + "</div>\n";
}

}  // namespace

std::string training_section(const Report& report) {
  const std::string_view heading = "How it learned";
  if (!report.curves || report.curves->steps == 0)
    return section_html("training", heading,
                        "<p>Nothing to show: there is no log of a run beside the model.</p>\n");
  const TrainingCurves& curves = *report.curves;
  std::string html = fmt::format(
      "<p>{} steps. A line is the mean of a stretch of steps, the shade around it reaches from the least to "
      "the largest value there. Stages of training begin at dashed lines; what they add up to a total differs. "
      "Of all losses lower is better; that of collapse is negative by its nature.</p>\n",
      curves.steps);
  if (curves.not_finite > 0)
    html += fmt::format("<p class=\"note\">{} losses were no finite number and are left out.</p>\n",
                        curves.not_finite);
  return section_html("training", heading, html + plots(report));
}

}  // namespace vkopple
