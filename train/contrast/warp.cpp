#include "train/contrast/warp.h"

#include <algorithm>
#include <cmath>

namespace vkopple {
namespace {

constexpr double kNearest = 1e-5;       // nothing nearer is seen
constexpr double kLeastWeight = 1e-22;  // keeps pixels on which nothing landed from 0 / 0

/// Where a point is seen, in pixels from the top left one's centre, and its signed distance.
struct Seen {
  double column, row, distance;
};

Seen project_point(const Lens& lens, const Vec3& p) {
  const double scale = lens.focal() / (std::abs(p[1]) + kNearest);
  const double distance = std::hypot(p[0], p[1], p[2]);
  return {scale * p[0] + (lens.width - 1) / 2.0, -scale * p[2] + (lens.height - 1) / 2.0,
          p[1] + kNearest > 0 ? distance : -distance};
}

}  // namespace

std::vector<Vec3> back_project_pixels(const Lens& lens, std::span<const float> depth) {
  std::vector<Vec3> points;
  points.reserve(depth.size());
  const double focal = lens.focal();
  for (int row = 0; row < lens.height; ++row)
    for (int column = 0; column < lens.width; ++column) {
      const Vec3 ray{(column - (lens.width - 1) / 2.0) / focal, 1, -(row - (lens.height - 1) / 2.0) / focal};
      const double scale = depth[points.size()] / std::hypot(ray[0], ray[1], ray[2]);
      points.push_back({scale * ray[0], scale * ray[1], scale * ray[2]});
    }
  return points;
}

Vec3 map_point(const Matrix4& map, const Vec3& point) {
  Vec3 moved{};
  for (std::size_t i = 0; i < 3; ++i)
    moved[i] = map[4 * i] * point[0] + map[4 * i + 1] * point[1] + map[4 * i + 2] * point[2] + map[4 * i + 3];
  return moved;
}

WarpedImage splat_pixels(const Lens& lens, double beta, std::span<const float> image,
                         std::span<const Vec3> points) {
  const std::size_t area = lens.pixels();
  WarpedImage out{std::vector<double>(3 * area), std::vector<double>(area)};
  std::vector<double> weight(area, kLeastWeight);
  for (std::size_t p = 0; p < area; ++p) {
    const Seen at = project_point(lens, points[p]);
    if (!(at.distance > kNearest)) continue;
    const double nearness = std::exp(-beta * at.distance);
    const double left = std::floor(at.column), top = std::floor(at.row);
    for (const double row : {top, top + 1})
      for (const double column : {left, left + 1}) {
        if (row < 0 || row >= lens.height || column < 0 || column >= lens.width) continue;
        const auto target = static_cast<std::size_t>(row) * static_cast<std::size_t>(lens.width) +
                            static_cast<std::size_t>(column);
        const double share = (1 - std::abs(at.column - column)) * (1 - std::abs(at.row - row));
        out.total[target] += share;
        weight[target] += share * nearness;
        for (std::size_t c = 0; c < 3; ++c)
          out.colour[c * area + target] += share * nearness * static_cast<double>(image[c * area + p]);
      }
  }
  for (std::size_t i = 0; i < out.colour.size(); ++i) out.colour[i] /= weight[i % area];
  return out;
}

}  // namespace vkopple
