#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/camera.h"

namespace vkopple {

/// Two frames of which everything is known: the middle one of a triplet, and the one to be predicted.
struct KnownTriplet {
  std::span<const float> image, next;    ///< (3, height, width) in [0, 1]
  std::span<const float> depth;          ///< (height, width) of `image`, Euclidean
  std::span<const std::uint32_t> label;  ///< likewise: 0 background, i + 1 object i
  /// Of each label: where the camera of `next` sees a point of it that the camera of `image` sees.
  std::vector<Matrix4> motion;
};

}  // namespace vkopple
