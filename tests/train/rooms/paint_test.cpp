#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "runtime/transfer.h"
#include "tests/support/test_device.h"
#include "train/rooms/renderer.h"

namespace vkopple {
namespace {

// Pictures against paint in double precision, a sample at a time. Where a sample's ray ends and on what, a
// picture of samples for pixels tells; renderer_test.cpp checks that. Light from nowhere makes shading a
// constant.

Vec3 sum(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vec3 times(const Vec3& a, double f) { return {f * a[0], f * a[1], f * a[2]}; }
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double fract(double x) { return x - std::floor(x); }
double wave(double x) {
  const double y = 2 * fract(x) - 1;
  return 4 * y * (std::abs(y) - 1);
}
double odd(double x) { return static_cast<double>(static_cast<int64_t>(std::floor(x)) & 1); }

double ripple(const Vec3& q) {
  return wave(0.27 * q[0] + 0.37 * wave(0.21 * q[1])) * wave(0.30 * q[1] + 0.27 * wave(0.18 * q[2])) *
         wave(0.24 * q[2] + 0.30 * wave(0.11 * q[0]));
}

double periodic(int pattern, const Vec3& q) {
  const auto [x, y, z] = q;
  const Vec3 cell{fract(x) - 0.5, fract(y) - 0.5, fract(z) - 0.5};
  const Vec3 wide{fract(x / 2) - 0.5, fract(y / 2) - 0.5, fract(z / 2) - 0.5};
  const double row = std::floor(2 * z), along = x + y + row / 2;
  const auto thin = [](double v) { return std::abs(v) < 0.12 ? 1 : 0; };
  switch (pattern) {
    case 0:
      return odd(std::floor(x) + std::floor(y) + std::floor(z));
    case 1:
      return odd(x + y + 0.3 * z);
    case 2:
      return std::hypot(cell[0], cell[1], cell[2]) < std::sqrt(0.27) ? 1 : 0;
    case 3:
      return ripple(q) > 0 ? 1 : 0;
    case 4:
      return fract(along) < 0.1 || fract(2 * z) < 0.2 ? 1 : 0.35 * odd(std::floor(along) + 3 * row);
    case 5:
      return odd(1.5 * z + 2 * std::abs(fract(x + y) - 0.5));
    case 6:
      return odd(5 * std::hypot(wide[0], wide[1], wide[2]));
    case 7:
      return (thin(cell[0]) + thin(cell[1]) + thin(cell[2])) % 2;
    default:
      return odd(1.3 * x + 0.4 * wave(0.5 * y) + 0.4 * wave(0.4 * z));
  }
}

double octaves(int count, const Vec3& p, double period) {
  double total = 0;
  for (int octave = 0; octave < count; ++octave) {
    const auto [x, y, z] = times(p, 0.24 * std::pow(2, octave) / period);
    total += std::pow(0.5, octave) * wave(x + 0.27 * wave(y + 0.16 * octave)) *
             wave(1.1 * y + z + 0.2 * wave(0.9 * z - x));
  }
  return 0.5 + 0.6 * total;
}

Vec3 mixed(const Vec3& a, const Vec3& b, double share) { return sum(times(a, 1 - share), times(b, share)); }

/// Of a point in the surface's frame.
Vec3 paint(const Material& m, const Vec3& point) {
  const Vec3 axis{m.turn[1], m.turn[2], m.turn[3]};
  const Vec3 p =
      sum(point, times(cross(axis, sum(cross(axis, point), times(point, m.turn[0]))), 2));  // by the quaternion
  const auto& [first, second, third] = m.colours;
  if (m.pattern < kFirstSmoothPattern) {
    const Vec3 q = sum(times(p, 1 / m.period), m.phase);
    return sum(times(mixed(second, first, periodic(m.pattern, q)), 0.75),
               times(third, 0.25 * (0.5 + 0.5 * ripple(q))));
  }
  double a = octaves(4, sum(p, m.phase), m.period);
  if (m.pattern == kFirstSmoothPattern + 1)
    a = 0.5 + 0.5 * wave(0.4 * (p[0] + p[1]) / m.period + 0.6 * a + m.phase[0]);
  const Vec3 base = mixed(second, first, std::clamp(a, 0.0, 1.0));
  if (m.pattern != kFirstSmoothPattern + 2) return base;
  const double clouds = octaves(2, {p[2] + m.phase[1], p[0] + m.phase[2], p[1] + m.phase[0]}, m.period);
  const double t = std::clamp((clouds - 0.35) / 0.4, 0.0, 1.0);
  return mixed(base, third, t * t * (3 - 2 * t));
}

Vec3 colour(const Scene& scene, int frame, const Vec3& point, uint32_t label) {
  if (label > 0) {
    const RoomObject& object = scene.objects[label - 1];
    const Vec3 to = sum(point, times(object.position(frame), -1));
    const double c = std::cos(object.yaw(frame)), s = std::sin(object.yaw(frame));
    return times(paint(object.material, {c * to[0] + s * to[1], c * to[1] - s * to[0], to[2]}), 0.65);
  }
  const double above = point[2], below = kRoomHeight - point[2];
  const double side = kRoomHalf - std::max(std::abs(point[0]), std::abs(point[1]));
  const Material& m = side < std::min(above, below) ? scene.wall : above < below ? scene.floor : scene.ceiling;
  return times(paint(m, point), 0.88);
}

constexpr int kSamples = 3;
// More lines than an invocation draws on any device, and no multiple of them.
const Lens kCoarse(43, 22, 1.5), kFine(kSamples * 43, kSamples * 22, 1.5);

/// What the picture of one frame should be: (3, height, width).
std::vector<double> expected(const Scene& scene, int frame, const std::vector<float>& depth,
                             const std::vector<uint32_t>& label) {
  const auto r = scene.cameras[static_cast<std::size_t>(frame)].rotation();
  const Vec3& eye = scene.cameras[static_cast<std::size_t>(frame)].position;
  const std::size_t area = kCoarse.pixels();
  std::vector<double> image(3 * area);
  for (int line = 0; line < kFine.height; ++line) {
    for (int column = 0; column < kFine.width; ++column) {
      const auto at = static_cast<std::size_t>(line * kFine.width + column);
      const Vec3 seen{(column + 0.5 - kFine.width / 2.0) / kFine.focal(), 1,
                      -(line + 0.5 - kFine.height / 2.0) / kFine.focal()};
      const double far = depth[at] / std::hypot(seen[0], seen[1], seen[2]);
      Vec3 point = eye;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) point[i] += far * r[i][k] * seen[k];
      const Vec3 rgb = colour(scene, frame, point, label[at]);
      for (std::size_t c = 0; c < 3; ++c)
        image[c * area + static_cast<std::size_t>(line / kSamples * kCoarse.width + column / kSamples)] +=
            rgb[c] / (kSamples * kSamples);
    }
  }
  return image;
}

class RoomPaint : public testing::TestWithParam<RoomTextures> {};

TEST_P(RoomPaint, PicturesAreTheMeanOfTheirSamples) {
  constexpr int kScenes = 8, kFrame = 1;
  RoomsConfig config;
  config.textures = GetParam();
  config.supersample = kSamples;
  config.objects = 4;
  std::vector<Scene> scenes;
  for (uint64_t i = 0; i < kScenes; ++i) {
    scenes.push_back(sample_scene(config, kCoarse.half_view(), 21, i));
    scenes.back().light = {0, 0, 0};
  }
  // All patterns, whatever chance chose.
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    Scene& scene = scenes[i];
    int next = static_cast<int>(i) * 3;
    for (Material* m : {&scene.wall, &scene.floor, &scene.ceiling}) {
      if (m->pattern < kFirstSmoothPattern)
        m->pattern = next++ % kPeriodicPatterns;
      else
        m->pattern = kFirstSmoothPattern + next++ % kSmoothPatterns;
    }
  }
  std::vector<View> views;
  for (const Scene& scene : scenes) views.push_back({&scene, kFrame});
  RoomRenderer coarse(test_device(), kCoarse, config, kScenes, RoomRenderer::Truth::kLeftOut);
  coarse.render(views);
  const auto image = download_values<float>(test_device(), coarse.image());
  config.supersample = 1;
  RoomRenderer fine(test_device(), kFine, config, kScenes);
  fine.render(views);
  const auto depth = download_values<float>(test_device(), fine.depth());
  const auto label = download_values<uint32_t>(test_device(), fine.label());

  std::size_t edges = 0;
  const std::size_t size = 3 * kCoarse.pixels(), samples = kFine.pixels();
  for (std::size_t i = 0; i < kScenes; ++i) {
    const auto from = static_cast<std::ptrdiff_t>(i * samples);
    const auto wanted = expected(
        scenes[i], kFrame, {depth.begin() + from, depth.begin() + from + static_cast<std::ptrdiff_t>(samples)},
        {label.begin() + from, label.begin() + from + static_cast<std::ptrdiff_t>(samples)});
    for (std::size_t k = 0; k < size; ++k) {
      const double error = std::abs(image[i * size + k] - wanted[k]);
      EXPECT_LT(error, 0.3);
      edges += error > 1e-3 ? 1 : 0;
    }
  }
  // A sample within rounding of a pattern's edge may fall on either side: about one value in 10^4, by a ninth
  // of two colours' difference.
  EXPECT_LE(edges, kScenes * size / 5000);
}

INSTANTIATE_TEST_SUITE_P(All, RoomPaint,
                         testing::Values(RoomTextures::kPeriodic, RoomTextures::kSmooth, RoomTextures::kMixed),
                         [](const auto& p) {
                           return std::string(kRoomTexturesNames[static_cast<std::size_t>(p.param)]);
                         });

}  // namespace
}  // namespace vkopple
