#pragma once

#include "models/layers.h"

namespace vkopple {

// The two functions that replace rigid motion in the relaxed variant (docs/model.md §8). `layers` is the group
// "motion".

/// Where what stands still at `location` (B, K, 3) is seen after the camera's move `ego` (B, K, 3).
Value learned_location(LayerFactory& layers, Value ego, Value location);

/// Where every pixel goes under each hypothesis, (B, K+1, 3, H, W), background last. objects: (B, K, 14),
/// still: (B, 1, 14), the numbers of kPixelMotionNumbers; points: (B, 3, H, W).
Value learned_pixels(LayerFactory& layers, Value objects, Value still, Value points);

}  // namespace vkopple
