#include "train/rooms/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "runtime/error.h"
#include "train/random.h"

namespace vkopple {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kAttempts = 1000000;
constexpr std::array<double, 2> kRoomSmooth{0.6, 1.0}, kObjectSmooth{0.2, 0.45};
constexpr double kCameraGap = 0.4;   // between an object's footprint and the camera
constexpr double kCameraWall = 0.1;  // between the camera and a wall

double square(double x) { return x * x; }

/// Where everything is; looks are drawn once this is accepted.
struct Layout {
  struct Mover {
    double size, yaw, spin;
    std::array<double, 2> start, velocity;
    std::array<double, 2> at(int frame) const {
      return {start[0] + velocity[0] * frame, start[1] + velocity[1] * frame};
    }
  };
  std::vector<Mover> movers;
  std::vector<RoomCamera> cameras;
};

Layout draw_layout(const RoomsConfig& config, Random& random) {
  Layout layout;
  for (int i = 0; i < config.objects; ++i) {
    Layout::Mover m{};
    m.size = random.between(config.size[0], config.size[1]);
    m.yaw = random.between(0, 2 * kPi);
    m.spin = random.between(-config.spin, config.spin);
    for (double& x : m.start) x = random.between(-kRoomHalf + 0.5, kRoomHalf - 0.5);
    for (double& v : m.velocity) v = random.between(-config.speed, config.speed);
    layout.movers.push_back(m);
  }
  const double side = random.between(0, 2 * kPi);
  const double radius = random.between(1.6, 2.2);
  RoomCamera camera;
  camera.position = {radius * std::cos(side), radius * std::sin(side), kEyeHeight};
  camera.yaw = side + kPi / 2 + random.between(-0.3, 0.3);  // towards the room's middle, about
  for (int frame = 0; frame < config.frames; ++frame) {
    if (frame > 0) {
      camera.position[0] += random.between(-config.camera_step, config.camera_step);
      camera.position[1] += random.between(-config.camera_step, config.camera_step);
      camera.yaw += random.between(-config.pan, config.pan);
    }
    layout.cameras.push_back(camera);
  }
  return layout;
}

/// Nothing touches anything in this frame.
bool is_free(const Layout& layout, int frame) {
  const RoomCamera& camera = layout.cameras[static_cast<std::size_t>(frame)];
  const Vec3& eye = camera.position;
  if (std::max(std::abs(eye[0]), std::abs(eye[1])) >= kRoomHalf - kCameraWall) return false;
  for (std::size_t i = 0; i < layout.movers.size(); ++i) {
    const auto& mover = layout.movers[i];
    const auto at = mover.at(frame);
    const double reach = kFootprint * mover.size;
    if (std::max(std::abs(at[0]), std::abs(at[1])) + reach >= kRoomHalf) return false;
    if (std::hypot(at[0] - eye[0], at[1] - eye[1]) <= reach + kCameraGap) return false;
    for (std::size_t j = 0; j < i; ++j) {
      const auto other = layout.movers[j].at(frame);
      if (std::hypot(at[0] - other[0], at[1] - other[1]) <= reach + kFootprint * layout.movers[j].size)
        return false;
    }
  }
  return true;
}

/// The part of the view, of `parts` even ones from left to right, that an object's middle is in; none beyond
/// nine tenths of the angle of view.
std::optional<int> sector_of(const Layout& layout, std::size_t object, int frame, double half_view, int parts) {
  const auto at = layout.movers[object].at(frame);
  const Vec3 seen = layout.cameras[static_cast<std::size_t>(frame)].see({at[0], at[1], kEyeHeight});
  const double across = std::atan2(seen[0], seen[1]) / (0.9 * half_view);
  if (std::abs(across) >= 1) return std::nullopt;
  return static_cast<int>(0.5 * (across + 1) * parts);
}

/// How many objects are ahead of the camera.
int count_ahead(const Layout& layout, int frame, double half_view) {
  int ahead = 0;
  for (std::size_t i = 0; i < layout.movers.size(); ++i)
    ahead += sector_of(layout, i, frame, half_view, 1) ? 1 : 0;
  return ahead;
}

/// Each object is in the same part of the view in all frames, and no other is in it.
bool keep_to_sectors(const Layout& layout, double half_view) {
  const auto objects = layout.movers.size();
  std::vector<bool> taken(objects);
  for (std::size_t i = 0; i < objects; ++i) {
    const auto first = sector_of(layout, i, 0, half_view, static_cast<int>(objects));
    if (!first || taken[static_cast<std::size_t>(*first)]) return false;
    taken[static_cast<std::size_t>(*first)] = true;
    for (int frame = 1; frame < static_cast<int>(layout.cameras.size()); ++frame)
      if (sector_of(layout, i, frame, half_view, static_cast<int>(objects)) != first) return false;
  }
  return true;
}

bool is_acceptable(const Layout& layout, const RoomsConfig& config, double half_view) {
  if (config.sectors && !keep_to_sectors(layout, half_view)) return false;
  int ahead = 0;
  const int frames = static_cast<int>(layout.cameras.size());
  // The last frame first: there things have moved farthest and most layouts fail.
  for (int frame = frames - 1; frame >= 0; --frame) {
    if (!is_free(layout, frame)) return false;
    ahead += count_ahead(layout, frame, half_view);
  }
  return 3 * ahead >= 2 * frames * static_cast<int>(layout.movers.size());
}

Vec3 draw_colour(Random& random) { return {random.uniform(), random.uniform(), random.uniform()}; }

double contrast(const Vec3& a, const Vec3& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Uniform over the rotations (Shoemake, "Uniform random rotations", 1992).
std::array<double, 4> draw_rotation(Random& random) {
  const double u = random.uniform(), s = 2 * kPi * random.uniform(), t = 2 * kPi * random.uniform();
  return {std::sqrt(1 - u) * std::sin(s), std::sqrt(1 - u) * std::cos(s), std::sqrt(u) * std::sin(t),
          std::sqrt(u) * std::cos(t)};
}

/// `smooth_period`: scale of smooth noise; an object needs a finer one than a wall to show any of it.
Material draw_material(RoomTextures textures, std::array<double, 2> smooth_period, Random& random) {
  Material m;
  const bool smooth =
      textures == RoomTextures::kSmooth || (textures == RoomTextures::kMixed && random.uniform() < 0.5);
  m.pattern = smooth ? kFirstSmoothPattern + static_cast<int>(random.below(kSmoothPatterns))
                     : static_cast<int>(random.below(kPeriodicPatterns));
  m.period = smooth ? random.between(smooth_period[0], smooth_period[1]) : random.between(0.12, 0.5);
  m.colours[0] = draw_colour(random);
  do m.colours[1] = draw_colour(random);
  while (contrast(m.colours[0], m.colours[1]) < 0.35);  // a pattern nobody sees teaches nothing
  m.colours[2] = draw_colour(random);
  for (double& p : m.phase) p = random.between(0, 10);
  if (random.uniform() < 0.5) m.turn = draw_rotation(random);
  return m;
}

/// A surface's colours, drawn towards their mean.
Material faded(Material m, double contrast) {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    double mean = 0;
    for (const Vec3& colour : m.colours) mean += colour[channel] / static_cast<double>(m.colours.size());
    for (Vec3& colour : m.colours) colour[channel] = std::lerp(mean, colour[channel], contrast);
  }
  return m;
}

Vec3 draw_light(Random& random) {
  const double around = random.between(0, 2 * kPi), up = random.between(0.5, 0.9);
  const double flat = std::sqrt(1 - up * up);
  return {flat * std::cos(around), flat * std::sin(around), up};
}

Scene furnish(const Layout& layout, const RoomsConfig& config, Random& random) {
  Scene scene;
  scene.cameras = layout.cameras;
  scene.light = draw_light(random);
  for (Material* surface : {&scene.wall, &scene.floor, &scene.ceiling})
    *surface = faded(draw_material(config.textures, kRoomSmooth, random), config.room_contrast);
  for (const auto& mover : layout.movers) {
    RoomObject object;
    object.shape = config.shapes[random.below(static_cast<std::uint32_t>(config.shapes.size()))];
    object.size = mover.size;
    object.solid = make_solid(object.shape, mover.size, random.between(0.3, 0.6));
    object.start = mover.start;
    object.velocity = mover.velocity;
    object.start_yaw = mover.yaw;
    object.spin = mover.spin;
    object.material = draw_material(config.textures, kObjectSmooth, random);
    scene.objects.push_back(object);
  }
  return scene;
}

}  // namespace

std::array<Vec3, 3> RoomCamera::rotation() const {
  const double cy = std::cos(yaw), sy = std::sin(yaw), cp = std::cos(pitch), sp = std::sin(pitch);
  const double cr = std::cos(roll), sr = std::sin(roll);
  return {Vec3{cy * cr - sy * sp * sr, -sy * cp, cy * sr + sy * sp * cr},
          Vec3{sy * cr + cy * sp * sr, cy * cp, sy * sr - cy * sp * cr}, Vec3{-cp * sr, sp, cp * cr}};
}

Vec3 RoomCamera::see(const Vec3& world) const {
  const auto r = rotation();
  Vec3 seen{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) seen[i] += r[k][i] * (world[k] - position[k]);
  }
  return seen;
}

std::array<float, 6> RoomCamera::numbers() const {
  return {static_cast<float>(position[0]), static_cast<float>(position[1]), static_cast<float>(position[2]),
          static_cast<float>(yaw),         static_cast<float>(pitch),       static_cast<float>(roll)};
}

Solid make_solid(RoomShape shape, double size, double tall) {
  Solid x;
  const auto measures = [&x](double a, double b, double h) { x.a = a, x.b = b, x.h = h; };
  const auto taper = [&x] { x.s0 = 0.5, x.s1 = -0.5 / x.h; };  // from 1 at the bottom to 0 at the top
  switch (shape) {
    case RoomShape::kCube:
      measures(0.8 * size, 0.8 * size, tall), x.kind = Solid::kSquare;
      break;
    case RoomShape::kCylinder:
      measures(0.8 * size, 0.8 * size, tall);
      break;
    case RoomShape::kLyingCylinder:
      measures(0.6 * size, 0.6 * size, size), x.lies = true;
      break;
    case RoomShape::kSphere:
      measures(size, size, size), x.e = 1 / square(x.h);
      break;
    case RoomShape::kCone:
      measures(size, size, 1.2 * tall), taper();
      break;
    case RoomShape::kPyramid:
      measures(0.8 * size, 0.8 * size, 1.2 * tall), taper(), x.kind = Solid::kSquare;
      break;
    case RoomShape::kTorus:
      measures(0.7 * size, 0.3 * size, size), x.kind = Solid::kTorus;
      break;
    case RoomShape::kPrism:
      measures(1.1 * size, 1.1 * size, tall), x.s0 = 0.5, x.kind = Solid::kTriangle;
      break;
    case RoomShape::kEllipsoid:
      measures(size, 0.65 * size, tall), x.e = 1 / square(x.h);
      break;
    case RoomShape::kDome:
      measures(size, size, 0.8 * tall), x.e = 0.25 / square(x.h), x.c = -x.h;
      break;
  }
  x.middle = x.lies ? x.a : x.h;
  const double flat = x.kind == Solid::kSquare ? std::numbers::sqrt2 * x.a : x.a;
  const bool rounded = x.e > 0 && x.c == 0;
  x.reach = rounded ? std::max(x.a, x.h) : x.kind == Solid::kTorus ? x.a + x.b : std::hypot(flat, x.h);
  return x;
}

Vec3 RoomObject::position(int frame) const {
  return {start[0] + velocity[0] * frame, start[1] + velocity[1] * frame, solid.middle};
}

Scene sample_scene(const RoomsConfig& config, double half_view, std::uint64_t seed, std::uint64_t index) {
  Random random(seed, index);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Layout layout = draw_layout(config, random);
    if (is_acceptable(layout, config, half_view)) return furnish(layout, config, random);
  }
  throw Error(
      fmt::format("rooms: {} objects of size {} to {}, speed {} and {} frames leave no free place in {} "
                  "attempts; make them fewer, smaller or slower",
                  config.objects, config.size[0], config.size[1], config.speed, config.frames, kAttempts));
}

}  // namespace vkopple
