#pragma once

#include <vector>

#include "models/camera.h"
#include "train/rooms/room_source.h"

namespace vkopple {

/// KnownTriplet::motion from the middle to the last frame of a triplet.
std::vector<Matrix4> room_motion(const RoomTriplet& triplet);

}  // namespace vkopple
