#include "train/contrast/room_motion.h"

namespace vkopple {
namespace {

CameraPose pose_of(const RoomCamera& camera) {
  const Vec3& at = camera.position;
  return {at[0], at[1], at[2], camera.yaw, camera.pitch, camera.roll};
}

/// An object's frame is that of a camera at its place.
CameraPose pose_of(const RoomObject& object, int frame) {
  const Vec3 at = object.position(frame);
  return {at[0], at[1], at[2], object.yaw(frame), 0, 0};
}

Matrix4 product(const Matrix4& a, const Matrix4& b) {
  Matrix4 out{};
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      for (std::size_t k = 0; k < 4; ++k) out[4 * row + column] += a[4 * row + k] * b[4 * k + column];
  return out;
}

}  // namespace

std::vector<Matrix4> room_motion(const RoomTriplet& triplet) {
  const int before = triplet.frames[1], after = triplet.frames[2];
  const CameraPose camera = pose_of(triplet.scene.cameras.at(static_cast<std::size_t>(before)));
  const CameraPose next = pose_of(triplet.scene.cameras.at(static_cast<std::size_t>(after)));
  std::vector<Matrix4> motion{relative(camera, next)};
  for (const RoomObject& object : triplet.scene.objects)
    motion.push_back(
        product(relative(pose_of(object, after), next), relative(camera, pose_of(object, before))));
  return motion;
}

}  // namespace vkopple
