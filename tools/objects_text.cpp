#include "tools/objects_text.h"

#include <fmt/format.h>

#include "models/camera.h"

namespace vkopple {
namespace {

std::string orientation_text(const SeenObject& o) {
  if (!o.rotation) return fmt::format("{:>6.2f} ({:.2f})", o.yaw, o.yaw_probability);
  const auto angles = euler_angles(*o.rotation);
  return fmt::format("{:>6.2f} {:>6.2f} {:>6.2f}", angles[0], angles[1], angles[2]);
}

}  // namespace

std::string objects_text(const std::vector<SeenObject>& objects,
                         const std::vector<std::optional<size_t>>& ids) {
  if (objects.empty()) return {};
  std::string text =
      fmt::format("  slot {}  share      x      y      z  angle  distance    yaw {}\n",
                  ids.empty() ? "" : "  id ", objects[0].rotation ? " pitch   roll" : "(probability)");
  for (size_t k = 0; k < objects.size(); ++k) {
    const SeenObject& o = objects[k];
    const std::string id = ids.empty() ? "" : fmt::format("{:>4} ", ids[k] ? std::to_string(*ids[k]) : "-");
    text += fmt::format("  {:>4} {}{:>6.1f}% {:>6.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>9.2f} {}\n", k, id,
                        100 * o.share, o.location[0], o.location[1], o.location[2], o.angle, o.distance,
                        orientation_text(o));
  }
  return text;
}

}  // namespace vkopple
