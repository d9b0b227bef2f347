#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/rooms_config.h"

namespace vkopple {

using Vec3 = std::array<double, 3>;

/// Half the side of the square room, its height, and the camera's height over the floor, in scene units. The
/// world's origin is the middle of the floor, z up.
inline constexpr double kRoomHalf = 2.5;
inline constexpr double kRoomHeight = 2.5;
inline constexpr double kEyeHeight = 0.7;

/// A camera's place and attitude: camera to world is Rz(yaw) Rx(pitch) Ry(roll); camera frame x right, y
/// forward, z up.
struct RoomCamera {
  Vec3 position{};
  double yaw = 0, pitch = 0, roll = 0;

  /// Rows of the camera-to-world rotation.
  std::array<Vec3, 3> rotation() const;
  /// A point of the world as the camera sees it.
  Vec3 see(const Vec3& world) const;
  /// x, y, z, yaw, pitch, roll.
  std::array<float, 6> numbers() const;
};

/// How a surface is painted; shaders/rooms/texture.glsl has the formulas.
struct Material {
  int pattern = 0;  ///< below kPeriodicPatterns periodic, from kFirstSmoothPattern on smooth
  double period = 1;
  std::array<Vec3, 3> colours{};
  Vec3 phase{};  ///< in periods, of smooth ones in scene units
  std::array<double, 4> turn{1, 0, 0,
                             0};  ///< unit quaternion w, x, y, z from the surface's frame to the pattern's
};
inline constexpr int kPeriodicPatterns = 9;
inline constexpr int kFirstSmoothPattern = 16;
inline constexpr int kSmoothPatterns = 3;

/// A solid as shaders/rooms/shapes.glsl has it, in its own frame: middle at the origin, z along its axis.
///
/// All but the torus are the part of |z| <= h where, with x' = x / a, y' = y / b and s(z) = s0 + s1 z,
///   round: x'^2 + y'^2 + e (z - c)^2 <= s(z)^2;   polygon: n_i . (x', y') <= s(z), n_i normals of a regular
///   triangle or square.
/// The torus has its axis along y, ring radius a, tube radius b.
struct Solid {
  enum Kind { kRound, kTriangle, kSquare, kTorus };
  Kind kind = kRound;
  double a = 1, b = 1, h = 1;
  double s0 = 1, s1 = 0;
  double e = 0, c = 0;
  bool lies = false;  ///< its z axis is the object's x axis
  double middle = 1;  ///< height of its middle when it stands on the floor
  double reach = 1;   ///< no point of it is farther from its middle
};
/// `size` bounds the footprint: no point is farther than kFootprint * size from the object's upright axis.
/// `tall` is the half height of those shapes whose height is free.
Solid make_solid(RoomShape shape, double size, double tall);
inline constexpr double kFootprint = 1.2;

struct RoomObject {
  RoomShape shape = RoomShape::kCube;
  double size = 0;
  Solid solid;
  std::array<double, 2> start{};     ///< x, y of its middle in frame 0
  std::array<double, 2> velocity{};  ///< units a frame
  double start_yaw = 0;
  double spin = 0;  ///< radians a frame
  Material material;

  /// Middle in a frame; it stands on the floor.
  Vec3 position(int frame) const;
  double yaw(int frame) const { return start_yaw + spin * frame; }
};

/// A room with moving objects seen by a moving camera.
struct Scene {
  std::vector<RoomObject> objects;
  std::vector<RoomCamera> cameras;  ///< one a frame
  Material wall, floor, ceiling;
  Vec3 light{};  ///< unit vector towards the light
};

/// The scene number `index` of `seed`, the same whatever was drawn before. Objects touch neither each other,
/// the walls nor the camera in any frame, and two thirds of them or more are ahead of the camera, counted over
/// all frames; with `sectors` each keeps to its part of the view. `half_view`: half the horizontal angle of
/// view, radians. Throws Error where the options leave no room for such a scene.
Scene sample_scene(const RoomsConfig& config, double half_view, std::uint64_t seed, std::uint64_t index);

}  // namespace vkopple
