#pragma once

#include "capi/vkopple.h"
#include "train/image.h"

namespace vkopple::capi {

/// A caller's image as the model takes it: the same values as read_rgb() makes of a file with these pixels.
/// Throws UsageError for a description that can't be, Error for pixels that are not numbers.
RgbImage read_image(const vkopple_image& image);

}  // namespace vkopple::capi
