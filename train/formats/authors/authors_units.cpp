#include "train/formats/authors/authors_units.h"

#include <numbers>

namespace vkopple {
namespace {

constexpr double kUnit = 10;  // of theirs in one of ours
constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

CameraPose own_camera(const AuthorsPose& pose) {
  return {pose[0] / kUnit,    pose[2] / kUnit,   pose[1] / kUnit,
          -pose[3] * kDegree, pose[4] * kDegree, pose[5] * kDegree};
}

AuthorsPose authors_camera(const CameraPose& pose) {
  return {pose[0] * kUnit,    pose[2] * kUnit,   pose[1] * kUnit,
          -pose[3] / kDegree, pose[4] / kDegree, pose[5] / kDegree};
}

PlacedObject own_object(const std::array<double, 3>& location, const std::array<double, 3>& pose) {
  return {{location[0] / kUnit, location[2] / kUnit, location[1] / kUnit},
          std::numbers::pi / 2 - pose[0] * kDegree};
}

std::array<double, 3> authors_location(const PlacedObject& object) {
  return {object.location[0] * kUnit, object.location[2] * kUnit, object.location[1] * kUnit};
}

std::array<double, 3> authors_object_pose(const PlacedObject& object) {
  return {(std::numbers::pi / 2 - object.yaw.value_or(0)) / kDegree, 0, 0};
}

}  // namespace vkopple
