#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Mask logits that fall with the distance from where the slot says its object is (`mask_window`, docs/model.md
/// §2.2): logit − ‖P − X‖² / (2 r²), P the pixel's point and X the slot's location. So a mask stays near
/// its slot's place, two slots share one only where they say the same place, and the image loss has a gradient
/// to X by way of masks. (A mask around a slot's own place is how Biza et al., "Invariant slot attention",
/// 2023, give decoders coordinates relative to the slot; the form is ours.) logits (K, B, H, W); points (B, 3,
/// H, W) and location (B, K, 3) in the camera's frame, scene units as the radius; all row-major.
Value mask_window(Value logits, Value points, Value location, double radius);

}  // namespace vkopple
