#include <fmt/format.h>

#include "train/report/html.h"
#include "train/report/picture_rows.h"
#include "train/report/report_page.h"

namespace vkopple {
namespace {

constexpr std::ptrdiff_t kInferredObjects = 1;

}  // namespace

std::string pictures_section(const Report& report) {
  const bool objects = report.has_learned(Network::kObject);
  std::vector<std::string> headings{"image", "inferred objects", "true objects", "inferred depth",
                                    "true depth"};
  if (!objects) headings.erase(headings.begin() + kInferredObjects);
  PictureRows rows(headings, 2);
  const auto& grid = report.held_out.grid;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    std::vector<RgbImage> pictures = grid[i];
    if (!objects) pictures.erase(pictures.begin() + kInferredObjects);
    const std::string name = fmt::format("Image {}", i + 1);
    rows.add(pictures, name, name);
  }
  std::string html = fmt::format(
      "<p>The first {} of the images. Objects are tinted and outlined in white, over the image in grey; "
      "colours tell the objects of one picture apart and mean nothing beyond it. Depth runs from bright yellow "
      "at the camera over red to black at {:g} scene units and beyond; what is unknown is black too.</p>\n",
      grid.size(), report.config.model.max_depth);
  if (!objects)
    html += "<p class=\"note\">The object network has not learned yet, so there are no inferred objects.</p>\n";
  return section_html("pictures", "What it sees", html + rows.html());
}

}  // namespace vkopple
