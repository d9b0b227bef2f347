#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "train/image.h"

namespace vkopple {

/// Colour of slot or object i, distinct for the first twelve; background is left as it is by overlay().
std::array<float, 3> label_colour(int index);

/// How many times a picture of that height is enlarged to be looked at.
int zoom_for(int height);

/// Every pixel becomes a square of `zoom` by `zoom`.
RgbImage enlarge(const RgbImage& image, int zoom);

/// The picture in grey, enlarged, with every pixel of an object tinted in its colour, and the objects' outlines
/// drawn a pixel wide. labels: an index for each pixel of `image`; `background` is the index that stays
/// untinted.
RgbImage overlay(const RgbImage& image, std::span<const int32_t> labels, int32_t background, int zoom = 1);

/// Depth as colour, from bright yellow (near) over red and purple to black (at `farthest` and beyond).
RgbImage depth_picture(const Plane<float>& depth, float farthest);

/// Values from 0 to 1 as grey, from black to white.
RgbImage grey_picture(const Plane<float>& plane);

/// One row of pictures a sample, all of one size, with thin white gaps.
RgbImage picture_grid(const std::vector<std::vector<RgbImage>>& rows);

}  // namespace vkopple
