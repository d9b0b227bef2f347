#include "train/rooms/scene_json.h"

namespace vkopple {
namespace {

using nlohmann::ordered_json;

ordered_json frame_json(const Scene& scene, int frame, const std::vector<uint64_t>& pixels) {
  const RoomCamera& camera = scene.cameras[static_cast<std::size_t>(frame)];
  ordered_json objects = ordered_json::array();
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const RoomObject& object = scene.objects[i];
    const Vec3 position = object.position(frame);
    objects.push_back({{"location", position},
                       {"location_in_camera", camera.see(position)},
                       {"yaw", object.yaw(frame)},
                       {"pixels", pixels[i]}});
  }
  const Vec3& at = camera.position;
  return {{"camera", {at[0], at[1], at[2], camera.yaw, camera.pitch, camera.roll}}, {"objects", objects}};
}

}  // namespace

ordered_json scene_json(const Scene& scene, const Lens& lens,
                        const std::vector<std::vector<uint64_t>>& pixels) {
  ordered_json objects = ordered_json::array();
  for (const RoomObject& object : scene.objects) {
    objects.push_back({{"shape", kRoomShapeNames[static_cast<std::size_t>(object.shape)]},
                       {"size", object.size},
                       {"velocity", {object.velocity[0], object.velocity[1], 0.0}},
                       {"spin", object.spin}});
  }
  ordered_json frames = ordered_json::array();
  for (std::size_t frame = 0; frame < scene.cameras.size(); ++frame) {
    frames.push_back(frame_json(scene, static_cast<int>(frame), pixels[frame]));
  }
  return {{"fov", lens.fov}, {"objects", objects}, {"frames", frames}};
}

}  // namespace vkopple
