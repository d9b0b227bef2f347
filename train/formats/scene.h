#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/camera.h"
#include "train/image.h"

namespace vkopple {

// A film as every data set holds it, whatever the format of its files. Axes and units are this project's, which
// readers convert to: the world is right-handed with z up, a camera's frame has x right, y forward, z up;
// lengths in scene units, angles in radians.

/// Where an object is in one frame.
struct PlacedObject {
  std::array<double, 3> location{};  ///< of its middle, in the world
  std::optional<double> yaw;         ///< counter-clockwise seen from above
};

/// A frame and what is known of it. All planes of a scene's frames have the size of the scene's images.
struct SceneFrame {
  /// 8-bit values v are v / 255, rounded; writing as PNG gives them back exactly.
  RgbImage image;
  /// Camera to world, x, y, z, yaw, pitch, roll: Rz(yaw) Rx(pitch) Ry(roll). Single images have none.
  std::optional<CameraPose> camera;
  /// Euclidean distance along the pixel's ray; 0 where it is unknown (sky). No pixels: no depth at all.
  Plane<float> depth;
  /// 0 background, i + 1 object i. No pixels: unknown.
  Plane<std::uint32_t> ids;
  /// Object i is number i of every frame of the scene, in sight or not. Nothing: unknown.
  std::optional<std::vector<PlacedObject>> objects;
};

/// A film, or a single image.
struct SceneData {
  /// Tells the scene from the others of its data set: letters, digits, '-' and '_'.
  std::string key;
  /// Where it was read, for messages: "film.tfrecord: record 12".
  std::string source;
  /// Vertical angle of view in radians, between 0 and pi. Pixels are square.
  double fov = 0;
  /// Scene units in one unit of where the scene came from.
  double scale = 1;
  std::vector<SceneFrame> frames;
  /// What object i is ("cube"); empty where unknown.
  std::vector<std::string> shapes;
};

/// Most frames of one scene. Readers cut longer films into several scenes.
inline constexpr std::size_t kMostSceneFrames = 120;
/// Most objects of one scene.
inline constexpr std::size_t kMostSceneObjects = 1000;
/// Largest amount of a coordinate, an angle or a depth: floats are exact enough below.
inline constexpr double kFarthest = 1e6;

/// Whether every depth is a number from 0 to kFarthest.
bool is_sound(const Plane<float>& depth);

/// Readers call this with each frame that they decoded, before the next one takes memory: throws Error, which
/// begins with `where`, if as many of its size are more than 2^26 pixels.
void check_film_size(std::size_t frames, const SceneFrame& frame, const std::string& where);

/// Throws Error, which begins with the source, where a scene breaks what is said above: no or too many frames,
/// sizes that differ, an angle of view or a number out of bounds, an id without its object.
void check_scene(const SceneData& scene);

}  // namespace vkopple
