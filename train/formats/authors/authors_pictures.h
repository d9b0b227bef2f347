#pragma once

#include <string>

#include "train/image.h"

namespace vkopple {

/// Most objects that the authors' label pictures have colours for.
inline constexpr std::uint32_t kAuthorsObjects = 3;

/// Labels of a picture in which red is background and green, blue and yellow are objects 1, 2 and 3. Throws
/// Error, which begins with `source`, for any other colour.
Plane<std::uint32_t> labels_of_colours(const RgbImage& picture, const std::string& source);
/// Throws Error for more than kAuthorsObjects.
RgbImage colours_of_labels(const Plane<std::uint32_t>& labels, const std::string& source);

/// Depth of a picture of 24 bits: (blue * 2^16 + green * 2^8 + red) / 2^16, below 256, times `unit`.
Plane<float> depth_of_colours(const RgbImage& picture, double unit);
/// Depth that is too large for the picture becomes the largest there is.
RgbImage colours_of_depth(const Plane<float>& depth, double unit);

}  // namespace vkopple
