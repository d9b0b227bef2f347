#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "models/strict_json.h"

namespace vkopple {

enum class RoomShape {
  kCube,
  kCylinder,
  kLyingCylinder,
  kSphere,
  kCone,
  kPyramid,
  kTorus,
  kPrism,
  kEllipsoid,
  kDome
};
inline constexpr std::array<std::string_view, 10> kRoomShapeNames{
    "cube", "cylinder", "lying_cylinder", "sphere", "cone", "pyramid", "torus", "prism", "ellipsoid", "dome"};

/// Periodic patterns with hard edges, octaves of smooth noise, or for each surface one or the other.
enum class RoomTextures { kPeriodic, kSmooth, kMixed };
inline constexpr std::array<std::string_view, 3> kRoomTexturesNames{"periodic", "smooth", "mixed"};

/// Options of the generated rooms. Lengths in scene units, angles in radians, speeds per frame.
struct RoomsConfig {
  int objects = 3;
  std::array<double, 2> size{0.25, 0.5};  ///< smallest and largest object
  double speed = 0.12;                    ///< an object's largest, along each of x and y
  double spin = 0.2;                      ///< an object's largest turn
  double camera_step = 0.1;               ///< the camera's largest, along each of x and y
  double pan = 0.12;                      ///< the camera's largest turn
  RoomTextures textures = RoomTextures::kMixed;
  double room_contrast = 1;  ///< of the colours of walls, floor and ceiling: 1 as drawn, 0 their mean
  /// The view is cut evenly from left to right into as many parts as there are objects, and each keeps to one
  /// of its own.
  bool sectors = false;
  std::vector<RoomShape> shapes = every_shape();
  int frames = 7;       ///< of a scene
  int supersample = 4;  ///< rays along each side of a pixel

  bool operator==(const RoomsConfig&) const = default;
  static std::vector<RoomShape> every_shape();
};

/// Reads the object's members over `base`; throws Error naming file and key.
RoomsConfig read_rooms_config(JsonObject object, const RoomsConfig& base);
nlohmann::ordered_json write_rooms_config(const RoomsConfig& config);

}  // namespace vkopple
