#include "train/rooms/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "runtime/transfer.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

Vec3 add(const Vec3& a, const Vec3& b, double factor) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// What a shape is, written from what its name says and not as the shader has it: a function of a point,
/// negative inside, about the distance near the surface. `s` size, `tall` half height as make_solid takes them;
/// z = 0 is the middle.
double field(RoomShape shape, double s, double tall, const Vec3& p) {
  const double x = p[0], y = p[1], z = p[2], r = std::hypot(x, y), ax = std::abs(x), ay = std::abs(y),
               az = std::abs(z);
  switch (shape) {
    case RoomShape::kCube:
      return std::max({ax - 0.8 * s, ay - 0.8 * s, az - tall});
    case RoomShape::kCylinder:
      return std::max(r - 0.8 * s, az - tall);
    case RoomShape::kLyingCylinder:
      return std::max(std::hypot(y, z) - 0.6 * s, ax - s);
    case RoomShape::kSphere:
      return std::sqrt(dot(p, p)) - s;
    case RoomShape::kCone:
      return std::max(r - s * (1.2 * tall - z) / (2.4 * tall), -1.2 * tall - z);
    case RoomShape::kPyramid:
      return std::max(std::max(ax, ay) - 0.8 * s * (1.2 * tall - z) / (2.4 * tall), -1.2 * tall - z);
    case RoomShape::kTorus:
      return std::hypot(std::hypot(x, z) - 0.7 * s, y) - 0.3 * s;
    case RoomShape::kPrism: {
      const double side = std::max({-x, 0.5 * x + std::sqrt(0.75) * y, 0.5 * x - std::sqrt(0.75) * y});
      return std::max(side - 0.55 * s, az - tall);
    }
    case RoomShape::kEllipsoid:
      return s * (std::hypot(x / s, y / (0.65 * s), z / tall) - 1);
    case RoomShape::kDome: {
      const double h = 0.8 * tall;
      return std::max(s * (std::hypot(x / s, y / s, (z + h) / (2 * h)) - 1), -h - z);
    }
  }
  return 1;
}

constexpr double kSize = 0.5, kTall = 0.45;

/// From where, and how the object is turned.
struct Stand {
  double yaw;
  RoomCamera camera;
};
const Stand kStands[] = {{0.7, {{-0.2, -0.6, 1.3}, -0.25, -0.5, 0.1}},
                         {2.9, {{1.9, 1.5, 0.4}, 1.9, 0.1, 0}},
                         {4.4, {{0.35, 0.55, 2.4}, 0.5, -1.35, 0}}};  // from above, steeper than a cone's side

/// One object in a room.
struct Still {
  RoomsConfig config;
  Scene scene;
  Lens lens{45, 61, 1.2};

  explicit Still(RoomShape shape, const Stand& stand = kStands[0]) {
    config.objects = 1;
    config.supersample = 1;
    RoomObject object;
    object.shape = shape;
    object.size = kSize;
    object.solid = make_solid(shape, kSize, kTall);
    object.start = {0.3, 0.9};
    object.start_yaw = stand.yaw;
    scene.objects = {object};
    scene.cameras = {stand.camera};
    scene.light = {0, 0, 1};
  }

  Vec3 ray(int line, int column) const {
    const auto r = scene.cameras[0].rotation();
    const double f = lens.height / 2.0 / std::tan(lens.fov / 2);
    const Vec3 seen{(column - (lens.width - 1) / 2.0) / f, 1, -(line - (lens.height - 1) / 2.0) / f};
    const double length = std::sqrt(dot(seen, seen));
    return {dot(r[0], seen) / length, dot(r[1], seen) / length, dot(r[2], seen) / length};
  }

  double room_depth(const Vec3& d) const {
    const Vec3& eye = scene.cameras[0].position;
    double nearest = std::numeric_limits<double>::infinity();
    const double walls[3][2] = {{-kRoomHalf, kRoomHalf}, {-kRoomHalf, kRoomHalf}, {0, kRoomHeight}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const double wall : walls[axis]) {
        const double t = (wall - eye[axis]) / d[axis];
        if (t > 0) nearest = std::min(nearest, t);
      }
    }
    return nearest;
  }

  /// The object's field at a point of the world.
  double object_field(const Vec3& p) const {
    const RoomObject& o = scene.objects[0];
    const Vec3 q = add(p, o.position(0), -1);
    const double c = std::cos(o.start_yaw), s = std::sin(o.start_yaw);
    return field(o.shape, kSize, kTall, {c * q[0] + s * q[1], c * q[1] - s * q[0], q[2]});
  }

  struct March {
    double closest = std::numeric_limits<double>::infinity();  ///< smallest field met
    std::optional<double> entry;
  };
  March march(const Vec3& d) const {
    March m;
    const Vec3& eye = scene.cameras[0].position;
    constexpr double kStep = 2e-3, kReach = 0.9;  // no shape of this size reaches farther
    const Vec3 to = add(scene.objects[0].position(0), eye, -1);
    const double nearest = dot(to, d);
    if (dot(to, to) - nearest * nearest > kReach * kReach) return m;
    for (double t = std::max(nearest - kReach, 0.0); t < nearest + kReach; t += kStep) {
      const double value = object_field(add(eye, d, t));
      m.closest = std::min(m.closest, value);
      if (value < 0 && !m.entry) m.entry = t - 0.5 * kStep;
    }
    return m;
  }
};

std::vector<float> pixels_of(const RoomRenderer& renderer, const Slice& images) {
  return download_values<float>(renderer.device(), images);
}

struct Pixels {
  std::vector<float> image, depth;
  std::vector<uint32_t> label;
};

Pixels draw(const Device& device, const Still& still, const Lens& lens) {
  RoomRenderer renderer(device, lens, still.config, 1);
  renderer.render({{&still.scene, 0}});
  return {pixels_of(renderer, renderer.image()), download_values<float>(device, renderer.depth()),
          download_values<uint32_t>(device, renderer.label())};
}

class RoomShapes : public testing::TestWithParam<RoomShape> {};

void check_geometry(const Still& still) {
  const Pixels got = draw(test_device(), still, still.lens);
  int covered = 0, doubtful = 0;
  for (int line = 0; line < still.lens.height; ++line) {
    for (int column = 0; column < still.lens.width; ++column) {
      const Vec3 d = still.ray(line, column);
      const auto i = static_cast<std::size_t>(line * still.lens.width + column);
      const auto march = still.march(d);
      if (std::abs(march.closest) < 3e-3) {
        ++doubtful;  // a graze: either answer will do
        continue;
      }
      ASSERT_EQ(got.label[i], march.entry ? 1U : 0U) << "pixel " << column << ", " << line;
      if (!march.entry) {
        EXPECT_NEAR(got.depth[i], still.room_depth(d), 2e-5);
        continue;
      }
      ++covered;
      EXPECT_NEAR(got.depth[i], *march.entry, 3e-3);
      EXPECT_NEAR(still.object_field(add(still.scene.cameras[0].position, d, got.depth[i])), 0, 2e-5);
    }
  }
  EXPECT_GT(covered, 80);
  EXPECT_LT(doubtful, 40);
}

TEST_P(RoomShapes, DepthAndLabelAgreeWithAMarchInDoublePrecision) {
  for (const Stand& stand : kStands) check_geometry(Still(GetParam(), stand));
}

void check_light(Still still) {
  Material plain;
  plain.pattern = kFirstSmoothPattern;
  plain.colours = {Vec3{1, 1, 1}, Vec3{1, 1, 1}, Vec3{1, 1, 1}};
  still.scene.objects[0].material = still.scene.floor = still.scene.wall = still.scene.ceiling = plain;
  still.scene.light = {0.48, -0.6, 0.64};
  const Pixels got = draw(test_device(), still, still.lens);
  const std::size_t area = got.depth.size();
  int checked = 0;
  for (std::size_t i = 0; i < area; ++i) {
    const Vec3 d = still.ray(static_cast<int>(i) / still.lens.width, static_cast<int>(i) % still.lens.width);
    const Vec3 p = add(still.scene.cameras[0].position, d, got.depth[i]);
    if (got.label[i] == 0) {
      if (p[2] < 1e-4 && std::max(std::abs(p[0]), std::abs(p[1])) < kRoomHalf - 1e-3) {
        EXPECT_NEAR(got.image[i], 0.88 + 0.12 * 0.64, 1e-5);
      }
      continue;
    }
    // The field's gradient by differences of two sizes; at an edge they disagree.
    const auto slope = [&](double step) {
      Vec3 g{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Vec3 up = p, down = p;
        up[axis] += step, down[axis] -= step;
        g[axis] = still.object_field(up) - still.object_field(down);
      }
      return dot(g, still.scene.light) / std::sqrt(dot(g, g));
    };
    const double fine = slope(1e-3), coarse = slope(1e-2);
    if (std::abs(fine - coarse) > 0.01) continue;
    ++checked;
    EXPECT_NEAR(got.image[i], 0.65 + 0.35 * fine, 5e-3) << "pixel " << i;
  }
  EXPECT_GT(checked, 60);
}

TEST_P(RoomShapes, LitByTheirOwnNormal) {
  for (const Stand& stand : kStands) check_light(Still(GetParam(), stand));
}

INSTANTIATE_TEST_SUITE_P(All, RoomShapes, testing::ValuesIn(RoomsConfig::every_shape()), [](const auto& shape) {
  return std::string(kRoomShapeNames[static_cast<std::size_t>(shape.param)]);
});

/// Scenes with everything in them.
std::vector<Scene> rich_scenes(const RoomsConfig& config, const Lens& lens, uint64_t count) {
  std::vector<Scene> scenes;
  for (uint64_t i = 0; i < count; ++i) scenes.push_back(sample_scene(config, lens.half_view(), 11, i));
  return scenes;
}

TEST(RoomRenderer, SupersamplingIsTheMeanOfAFinerPicture) {
  RoomsConfig config;
  const Lens lens(20, 28, 1.5), fine(80, 112, 1.5);
  const auto scenes = rich_scenes(config, lens, 2);
  const std::vector<View> views{{&scenes[0], 0}, {&scenes[1], 3}};
  RoomRenderer coarse(test_device(), lens, config, 2);
  coarse.render(views);
  config.supersample = 1;
  RoomRenderer sharp(test_device(), fine, config, 2);
  sharp.render(views);
  const auto a = pixels_of(coarse, coarse.image()), b = pixels_of(sharp, sharp.image());
  double difference = 0;
  for (std::size_t plane = 0; plane < 6; ++plane) {
    for (std::size_t y = 0; y < 20; ++y) {
      for (std::size_t x = 0; x < 28; ++x) {
        double mean = 0;
        for (std::size_t k = 0; k < 16; ++k) mean += b[(plane * 80 + 4 * y + k / 4) * 112 + 4 * x + k % 4] / 16;
        difference += std::abs(mean - a[(plane * 20 + y) * 28 + x]) / (6 * 20 * 28);
      }
    }
  }
  EXPECT_LT(difference, 1e-3);  // single samples may fall on the other side of a pattern's edge
}

TEST(RoomRenderer, AViewIsTheSameInAnyCompany) {
  const RoomsConfig config;
  const Lens lens(17, 23, 1.5);
  const auto scenes = rich_scenes(config, lens, 3);
  RoomRenderer three(test_device(), lens, config, 3), one(test_device(), lens, config, 1);
  three.render({{&scenes[0], 1}, {&scenes[1], 2}, {&scenes[2], 6}});
  one.render({{&scenes[1], 2}});
  const uint64_t bytes = one.image().bytes;
  EXPECT_EQ(pixels_of(one, one.image()), pixels_of(three, three.image().sub(bytes, bytes)));
  one.render({{&scenes[2], 6}});
  EXPECT_EQ(pixels_of(one, one.image()), pixels_of(three, three.image().sub(2 * bytes, bytes)));
}

TEST(RoomRenderer, TooMuchAtOnceIsAnError) {
  test::expect_error([] { RoomRenderer(test_device(), Lens(4096, 4096, 1.5), RoomsConfig{}, 100); },
                     {"4096 x 4096", "fewer"});
}

TEST(RoomRenderer, BothAccessPathsDrawTheSame) {
  const Device* other = other_access_device();
  if (other == nullptr) GTEST_SKIP() << missing_for(AccessPath::kTexel, test_device().caps());
  const Still still(RoomShape::kTorus);
  const Pixels a = draw(test_device(), still, still.lens), b = draw(*other, still, still.lens);
  for (std::size_t i = 0; i < a.depth.size(); ++i) EXPECT_NEAR(a.depth[i], b.depth[i], 1e-4);
  EXPECT_EQ(a.label, b.label);
}

TEST(RoomRenderer, KernelsAreChosenByWhatCompilesThem) {
  Caps caps;
  caps.type = DeviceType::kDiscrete;
  EXPECT_EQ(RoomRenderer::kernel_for(caps), RoomRenderer::Kernel::kSorted);
  caps.type = DeviceType::kCpu;
  EXPECT_EQ(RoomRenderer::kernel_for(caps), RoomRenderer::Kernel::kPlain);
  caps.lavapipe = true;
  EXPECT_EQ(RoomRenderer::kernel_for(caps), RoomRenderer::Kernel::kSorted);
}

TEST(RoomRenderer, BothKernelsDrawTheSame) {
  using Kernel = RoomRenderer::Kernel;
  if (RoomRenderer::kernel_for(test_device().caps()) != Kernel::kSorted)
    GTEST_SKIP() << test_device().caps().name << " takes too much memory to compile the long one";
  RoomsConfig config;
  config.textures = RoomTextures::kMixed;
  const Lens lens(37, 48, 1.5);  // 37 lines: neither kernel's columns end with the picture
  const auto scenes = rich_scenes(config, lens, 6);
  std::vector<View> views;
  for (const Scene& scene : scenes) views.push_back({&scene, 2});
  RoomRenderer sorted(test_device(), lens, config, 6, RoomRenderer::Truth::kLeftOut, Kernel::kSorted);
  RoomRenderer plain(test_device(), lens, config, 6, RoomRenderer::Truth::kLeftOut, Kernel::kPlain);
  sorted.render(views);
  plain.render(views);
  const auto a = pixels_of(sorted, sorted.image()), b = pixels_of(plain, plain.image());
  std::size_t apart = 0;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    apart += std::abs(a[i] - b[i]) > 1e-3F ? 1 : 0;
    sum += std::abs(a[i] - b[i]);
  }
  // Single samples, of 16, may fall on the other side of an edge.
  EXPECT_LT(static_cast<double>(apart), 0.01 * static_cast<double>(a.size()));
  EXPECT_LT(sum / static_cast<double>(a.size()), 1e-3);
}

TEST(RoomRenderer, PicturesAreColouredAndVaried) {
  const RoomsConfig config;
  const Lens lens(32, 32, 1.57);
  const auto scenes = rich_scenes(config, lens, 8);
  RoomRenderer renderer(test_device(), lens, config, 8);
  std::vector<View> views;
  for (const Scene& scene : scenes) views.push_back({&scene, 3});
  renderer.render(views);
  const auto image = pixels_of(renderer, renderer.image());
  for (std::size_t plane = 0; plane < 24; ++plane) {
    const auto begin = image.begin() + static_cast<std::ptrdiff_t>(plane * 1024);
    const auto [low, high] = std::minmax_element(begin, begin + 1024);
    EXPECT_GE(*low, 0);
    EXPECT_LE(*high, 1);
    EXPECT_GT(*high - *low, 0.1) << "plane " << plane;
  }
}

}  // namespace
}  // namespace vkopple
