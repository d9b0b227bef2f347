#pragma once

#include <span>
#include <vector>

#include "models/camera.h"
#include "train/rooms/renderer.h"

namespace vkopple {

// The model's warp (docs/model.md §1, §5) in double precision, of pixels that belong to one thing each.
// Pictures are (3, height, width) and maps (height, width) of the lens.

/// The point in the camera's frame that each pixel shows. depth: Euclidean.
std::vector<Vec3> back_project_pixels(const Lens& lens, std::span<const float> depth);

/// A point after a map of points.
Vec3 map_point(const Matrix4& map, const Vec3& point);

/// A picture whose pixels were thrown forward.
struct WarpedImage {
  std::vector<double> colour;  ///< mean of what landed on a pixel, what is near counting more
  std::vector<double> total;   ///< how much landed, by bilinear weights: 1 where a surface keeps its size
};

/// Throws each pixel of `image` to where the camera sees its point of `points`. beta: how fast its weight falls
/// with its distance, in 1 / scene unit.
WarpedImage splat_pixels(const Lens& lens, double beta, std::span<const float> image,
                         std::span<const Vec3> points);

}  // namespace vkopple
