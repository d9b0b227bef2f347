#include <fmt/format.h>

#include <algorithm>

#include "train/report/html.h"
#include "train/report/polar_plot.h"
#include "train/report/report_page.h"

namespace vkopple {
namespace {

std::string nothing_to_show(const Report& report) {
  if (!report.has_learned(Network::kObject)) return "the object network has not learned yet";
  if (report.config.model.orientation != Orientation::kYaw)
    return "a model of 3D rotation gives a single rotation and no distribution over yaw";
  return "no object of the first images was matched with a slot";
}

}  // namespace

std::string poses_section(const Report& report) {
  const std::string_view heading = "How it sees them turned";
  const auto& yaws = report.held_out.yaws;
  if (!report.has_learned(Network::kObject) || yaws.empty())
    return section_html("poses", heading,
                        fmt::format("<p>Nothing to show: {}.</p>\n", nothing_to_show(report)));
  std::string html = fmt::format(
      "<p>Probability of each of the {} bins of yaw of objects that are matched with a slot, seen from above: "
      "up is away from the camera, angles grow counter-clockwise, the most likely bin reaches the rim. Dashed: "
      "bins as likely as each other, where nothing is known. The stroke outside the rim is the true yaw, where "
      "it is known.</p>\n"
      "<p class=\"note\">The model chooses for itself where an object’s yaw begins, so between stroke and peak "
      "lies an angle of the object’s own, unknown and the same in all its frames. The shape tells how sure the "
      "model is; the distance from stroke to peak tells nothing.</p>\n<div class=\"plots small\">\n",
      report.config.model.bins);
  for (const SeenYaw& yaw : yaws)
    html += figure_html(
        polar_plot(yaw.probabilities, yaw.truth,
                   fmt::format("Distribution over yaw, image {}, slot {}", yaw.image + 1, yaw.slot + 1)),
        fmt::format("Image {}, slot {}, IoU {:.2f}; at the rim {:.1f} %", yaw.image + 1, yaw.slot + 1, yaw.iou,
                    100 * *std::max_element(yaw.probabilities.begin(), yaw.probabilities.end())));
  return section_html("poses", heading, html + "</div>\n");
}

}  // namespace vkopple
