#include <fmt/format.h>

#include "train/pictures.h"
#include "train/report/html.h"
#include "train/report/picture_rows.h"
#include "train/report/report_page.h"

namespace vkopple {
namespace {

constexpr std::string_view kNone =
    "<p>Nothing to show: the data do not tell where the camera was, which a prediction needs.</p>\n";

std::string errors(const Prediction& p) {
  const RgbImage& truth = p.truth.frames[2];
  return fmt::format(
      "mean squared error: blended {:.5f}, warped {:.5f}, imagined {:.5f}, frame 2 left as it is {:.5f}",
      mean_squared_error(p.predicted.predicted, truth), mean_squared_error(p.predicted.warped, truth),
      mean_squared_error(p.predicted.imagined, truth), mean_squared_error(p.truth.frames[1], truth));
}

}  // namespace

std::string prediction_section(const Report& report) {
  if (report.predictions.empty()) return section_html("predictions", "What it predicts", std::string(kNone));
  PictureRows rows(
      {"frame 1", "frame 2", "warped", "weight of the warp", "imagined", "blended", "true frame 3"}, 2);
  for (std::size_t i = 0; i < report.predictions.size(); ++i) {
    const Prediction& p = report.predictions[i];
    const std::string name = fmt::format("Triplet {}", i + 1);
    rows.add({p.truth.frames[0], p.truth.frames[1], p.predicted.warped, grey_picture(p.predicted.weight),
              p.predicted.imagined, p.predicted.predicted, p.truth.frames[2]},
             name, fmt::format("{}, {}", name, errors(p)));
  }
  const std::string html =
      "<p>The third frame of a triplet, predicted from the two before and the camera’s motion. Warped: the "
      "pixels of frame 2, moved as their objects and the camera move; black where nothing lands. Imagined: "
      "what the imagination network draws. Blended: both, by the weight, white where the warped image counts "
      "alone. Errors are of colours from 0 to 1; a prediction should beat frame 2 left as it is.</p>\n";
  return section_html("predictions", "What it predicts", html + rows.html());
}

}  // namespace vkopple
