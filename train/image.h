#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vkopple {

/// No picture that comes from outside is larger.
inline constexpr int kLargestSide = 16384;
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 26;

/// One value per pixel, row by row from the top left.
template <class T>
struct Plane {
  int height = 0, width = 0;
  std::vector<T> pixels;

  Plane() = default;
  Plane(int rows, int columns)
      : height(rows),
        width(columns),
        pixels(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns)) {}
};

/// Colours in [0, 1], planar: all red, then all green, then all blue; (3, height, width).
struct RgbImage {
  int height = 0, width = 0;
  std::vector<float> pixels;

  RgbImage() = default;
  RgbImage(int rows, int columns)
      : height(rows),
        width(columns),
        pixels(3 * static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns)) {}
};

/// What a data set stores beside a picture.
struct DepthAndIds {
  Plane<float> depth;        ///< Euclidean distance, scene units
  Plane<std::uint32_t> ids;  ///< 0 background, 1.. objects
};

/// A part of a picture, in pixels from its top left corner; whole pixels or not.
struct Window {
  double top = 0, left = 0, height = 0, width = 0;
};

/// To any size, each axis on its own: where it shrinks, an output pixel is the mean over the area it covers;
/// where it grows, linear interpolation between pixel centres.
RgbImage resize(const RgbImage& image, int height, int width);
Plane<float> resize(const Plane<float>& plane, int height, int width);
/// The same of a part, which must lie within the picture.
RgbImage resize(const RgbImage& image, const Window& part, int height, int width);

/// Depth: as above, but where it is unknown (0) anywhere in the plane, the value of the nearest pixel.
Plane<float> resize_depth(const Plane<float>& depth, const Window& part, int height, int width);
Plane<float> resize_depth(const Plane<float>& depth, int height, int width);

/// The pixel whose area holds the output pixel's centre: for labels, which can't be mixed.
Plane<std::uint32_t> resize_nearest(const Plane<std::uint32_t>& plane, int height, int width);
Plane<std::uint32_t> resize_nearest(const Plane<std::uint32_t>& plane, const Window& part, int height,
                                    int width);

}  // namespace vkopple
