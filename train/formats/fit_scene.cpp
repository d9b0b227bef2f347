#include "train/formats/fit_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/error.h"
#include "train/quote.h"

namespace vkopple {
namespace {

/// What of the pictures is kept, and the size that it gets.
struct Cut {
  Window window;
  int height = 0, width = 0;
};

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

Cut cut_for(const SceneData& scene, const SceneFit& fit) {
  const int height = scene.frames.at(0).image.height, width = scene.frames[0].image.width;
  const double part = fit.fov ? std::tan(*fit.fov / 2) / std::tan(scene.fov / 2) : 1;
  const double slack = 1e-9;
  if (part > 1 + slack)
    throw Error(
        fmt::format("{}: pictures of {:.4g} degrees from top to bottom can't show {:.4g}; ask for a smaller "
                    "angle of view",
                    one_line(scene.source, 4096), degrees(scene.fov), degrees(*fit.fov)));
  double rows = std::min(part, 1.0) * height;
  // Rounded up, so that columns are cropped and rows, which the angle of view spans, are not.
  const int kept_ratio =
      fit.width ? (*fit.width * height + width - 1) / width : std::max(static_cast<int>(rows), 1);
  Cut cut{{}, fit.height.value_or(kept_ratio), 0};
  cut.width = fit.width.value_or(std::max(cut.height * width / height, 1));
  const double ratio = static_cast<double>(cut.width) / cut.height;
  if (!fit.fov) rows = std::min(rows, width / ratio);
  if (rows * ratio > width * (1 + slack))
    throw Error(
        fmt::format("{}: pictures of {} x {} are too narrow for {:.4g} degrees at {} x {}; ask for a smaller "
                    "angle of view or a smaller width",
                    one_line(scene.source, 4096), width, height, degrees(*fit.fov), cut.width, cut.height));
  const double columns = std::min(rows * ratio, static_cast<double>(width));
  cut.window = {(height - rows) / 2, (width - columns) / 2, rows, columns};
  return cut;
}

void scale_lengths(SceneFrame& frame, double scale) {
  if (frame.camera)
    for (std::size_t i = 0; i < 3; ++i) (*frame.camera)[i] *= scale;
  for (float& depth : frame.depth.pixels) depth *= static_cast<float>(scale);
  if (!frame.objects) return;
  for (PlacedObject& object : *frame.objects)
    for (double& coordinate : object.location) coordinate *= scale;
}

}  // namespace

SceneData fitted(SceneData scene, const SceneFit& fit) {
  const Cut cut = cut_for(scene, fit);
  const int height = scene.frames[0].image.height;
  scene.scale *= fit.scale;
  for (SceneFrame& frame : scene.frames) {
    frame.image = resize(frame.image, cut.window, cut.height, cut.width);
    if (!frame.depth.pixels.empty()) frame.depth = resize_depth(frame.depth, cut.window, cut.height, cut.width);
    if (!frame.ids.pixels.empty()) frame.ids = resize_nearest(frame.ids, cut.window, cut.height, cut.width);
    if (fit.scale != 1) scale_lengths(frame, fit.scale);
  }
  if (fit.fov)
    scene.fov = *fit.fov;
  else if (cut.window.height != height)
    scene.fov = 2 * std::atan(cut.window.height / height * std::tan(scene.fov / 2));
  return scene;
}

}  // namespace vkopple
