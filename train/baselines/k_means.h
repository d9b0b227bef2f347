#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vkopple {

/// Rounds of assigning pixels to the nearest centre and moving centres to their pixels' mean.
inline constexpr int kKMeansRounds = 10;

/// Cuts a picture (3, height, width), colours from 0 to 1, into clusters of pixels that are near each other in
/// colour and place: 5 numbers, of which the place's are in units of the picture's longer side. The label of
/// each pixel; the last one is the cluster with the most pixels on the picture's border.
///
/// The same picture gives the same clusters: the first centre starts at the pixel nearest to the mean of all,
/// every other at the pixel farthest from those before. One that loses all its pixels stays where it is.
std::vector<std::int32_t> k_means_labels(std::span<const float> image, int height, int width, int clusters);

}  // namespace vkopple
