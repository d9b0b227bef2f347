#include "train/rooms/scene_pack.h"

#include <cmath>

namespace vkopple {
namespace {

constexpr int kLying = 8;

/// Rows of the rotation by a unit quaternion w, x, y, z.
std::array<Vec3, 3> rotation_of(const std::array<double, 4>& q) {
  const auto [w, x, y, z] = q;
  return {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
          Vec3{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
          Vec3{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

class Rows {
 public:
  explicit Rows(std::vector<float>& out) : out_(&out) {}
  void add(double x, double y, double z, double w) {
    for (const double v : {x, y, z, w}) out_->push_back(static_cast<float>(v));
  }
  void add(const Vec3& v, double w) { add(v[0], v[1], v[2], w); }

  void add(const Material& m) {
    const bool smooth = m.pattern >= kFirstSmoothPattern;
    const auto rotation = rotation_of(m.turn);
    Vec3 phase = m.phase;
    if (smooth)
      for (double& p : phase) p /= m.period;
    for (std::size_t i = 0; i < 3; ++i)
      add(rotation[i][0] / m.period, rotation[i][1] / m.period, rotation[i][2] / m.period, phase[i]);
    add(m.colours[0], m.pattern);
    add(m.colours[1], m.phase[0] - 0.4 * (phase[0] + phase[1]));
    add(m.colours[2], 0);
  }

 private:
  std::vector<float>* out_;
};

}  // namespace

void pack_view(const Scene& scene, int frame, std::vector<float>& out) {
  Rows rows(out);
  const RoomCamera& camera = scene.cameras.at(static_cast<std::size_t>(frame));
  rows.add(camera.position, static_cast<double>(scene.objects.size()));
  const auto rotation = camera.rotation();
  for (std::size_t i = 0; i < 3; ++i) rows.add(rotation[i], scene.light[i]);
  rows.add(kRoomHalf, kRoomHeight, 0, 0);
  for (const RoomObject& object : scene.objects) {
    const Solid& solid = object.solid;
    rows.add(object.position(frame), solid.kind + (solid.lies ? kLying : 0));
    rows.add(std::cos(object.yaw(frame)), std::sin(object.yaw(frame)), solid.reach, solid.h);
    rows.add(solid.a, solid.b, solid.s0, solid.s1);
    rows.add(solid.e, solid.c, 0, 0);
    rows.add(object.material);
  }
  for (const Material* material : {&scene.wall, &scene.floor, &scene.ceiling}) rows.add(*material);
}

}  // namespace vkopple
