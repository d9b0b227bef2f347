#pragma once

#include <cstddef>
#include <vector>

#include "train/rooms/scene.h"

namespace vkopple {

// A view (one frame of one scene) as shaders/rooms/room_raycast.comp reads it, in rows of 4 floats:
//
//   row 0      camera x, y, z; number of objects
//   rows 1-3   row i of the camera-to-world rotation; component i of the direction to the light
//   row 4      half the room's side; its height; 0; 0
//   objects    9 rows each: middle x, y, z, kind of solid (+ 8 where it lies) | cos yaw, sin yaw, reach, h | a,
//   b, s0, s1 |
//              e, c, 0, 0 | material
//   wall, floor, ceiling: a material each
//
// A material is 6 rows: row i of its rotation over its period, component i of its phase, in the unit of the
// period | colour 0, pattern | colour 1, shift of marble's veins | colour 2, 0.
inline constexpr std::size_t kHeaderRows = 5;
inline constexpr std::size_t kMaterialRows = 6;
inline constexpr std::size_t kObjectRows = 4 + kMaterialRows;
inline constexpr std::size_t kRoomSurfaces = 3;

/// Floats of one view.
constexpr std::size_t packed_view_size(std::size_t objects) {
  return 4 * (kHeaderRows + objects * kObjectRows + kRoomSurfaces * kMaterialRows);
}

/// Appends packed_view_size(scene.objects.size()) floats.
void pack_view(const Scene& scene, int frame, std::vector<float>& out);

}  // namespace vkopple
