#include "train/image.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "runtime/error.h"

namespace vkopple {
namespace {

/// An output pixel is a weighted sum of `weights.size()` neighbouring input pixels from `first` on.
struct Share {
  int first;
  std::vector<float> weights;
};

Share area_share(double from, double to, int size) {
  const int first = std::min(static_cast<int>(from), size - 1);
  const int last = std::clamp(static_cast<int>(std::ceil(to)) - 1, first, size - 1);
  Share share{first, {}};
  for (int i = first; i <= last; ++i) {
    const double covered = std::min(to, i + 1.0) - std::max(from, static_cast<double>(i));
    share.weights.push_back(static_cast<float>(std::max(covered, 0.0) / (to - from)));
  }
  return share;
}

Share linear_share(double centre, int size) {
  const double at = std::clamp(centre - 0.5, 0.0, size - 1.0);
  const int first = std::max(std::min(static_cast<int>(at), size - 2), 0);
  const auto part = static_cast<float>(at - first);
  return size == 1 ? Share{0, {1.0f}} : Share{first, {1 - part, part}};
}

/// Of a stretch of `size` pixels, which begins at `begin` and is `length` long.
std::vector<Share> shares(double begin, double length, int size, int to) {
  const double scale = length / to;
  std::vector<Share> all;
  for (int i = 0; i < to; ++i) {
    all.push_back(scale > 1 ? area_share(begin + i * scale, begin + (i + 1) * scale, size)
                            : linear_share(begin + (i + 0.5) * scale, size));
  }
  return all;
}

std::size_t index(int row, int column, int width) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
}

void check_sizes(int height, int width, const Window& part, int new_height, int new_width) {
  const double slack = 1e-6 * (height + width);  // of products that came out a little too large
  const bool inside = part.top >= -slack && part.left >= -slack && part.height > 0 && part.width > 0 &&
                      part.top + part.height <= height + slack && part.left + part.width <= width + slack;
  if (height > 0 && width > 0 && inside && new_height > 0 && new_width > 0) return;
  throw Error(fmt::format("{}x{} of an image of {}x{} can't be resized to {}x{}", part.height, part.width,
                          height, width, new_height, new_width));
}

bool is_all(const Window& part, int height, int width) {
  return part.top == 0 && part.left == 0 && part.height == height && part.width == width;
}

Window all_of(int height, int width) { return {0, 0, static_cast<double>(height), static_cast<double>(width)}; }

void resize_plane(std::span<const float> in, int height, int width, const Window& part, std::span<float> out,
                  int new_height, int new_width) {
  const std::vector<Share> columns = shares(part.left, part.width, width, new_width),
                           rows = shares(part.top, part.height, height, new_height);
  std::vector<float> narrow(index(height, 0, new_width));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < new_width; ++x) {
      const Share& share = columns[static_cast<std::size_t>(x)];
      double sum = 0;
      for (std::size_t i = 0; i < share.weights.size(); ++i) {
        sum += static_cast<double>(share.weights[i]) * in[index(y, share.first, width) + i];
      }
      narrow[index(y, x, new_width)] = static_cast<float>(sum);
    }
  }
  for (int y = 0; y < new_height; ++y) {
    const Share& share = rows[static_cast<std::size_t>(y)];
    for (int x = 0; x < new_width; ++x) {
      double sum = 0;
      for (std::size_t i = 0; i < share.weights.size(); ++i) {
        sum += static_cast<double>(share.weights[i]) *
               narrow[index(share.first + static_cast<int>(i), x, new_width)];
      }
      out[index(y, x, new_width)] = static_cast<float>(sum);
    }
  }
}

template <class T>
Plane<T> nearest(const Plane<T>& plane, const Window& part, int height, int width) {
  check_sizes(plane.height, plane.width, part, height, width);
  const auto sources = [](double begin, double length, int size, int to) {
    std::vector<int> all;
    for (int i = 0; i < to; ++i)
      all.push_back(std::clamp(static_cast<int>(begin + (2 * i + 1) * length / (2.0 * to)), 0, size - 1));
    return all;
  };
  const std::vector<int> rows = sources(part.top, part.height, plane.height, height),
                         columns = sources(part.left, part.width, plane.width, width);
  Plane<T> result(height, width);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      result.pixels[index(y, x, width)] = plane.pixels[index(
          rows[static_cast<std::size_t>(y)], columns[static_cast<std::size_t>(x)], plane.width)];
  return result;
}

Plane<float> mixed(const Plane<float>& plane, const Window& part, int height, int width) {
  check_sizes(plane.height, plane.width, part, height, width);
  if (is_all(part, plane.height, plane.width) && plane.height == height && plane.width == width) return plane;
  Plane<float> result(height, width);
  resize_plane(plane.pixels, plane.height, plane.width, part, result.pixels, height, width);
  return result;
}

}  // namespace

RgbImage resize(const RgbImage& image, const Window& part, int height, int width) {
  check_sizes(image.height, image.width, part, height, width);
  if (is_all(part, image.height, image.width) && image.height == height && image.width == width) return image;
  RgbImage result(height, width);
  const std::size_t from = image.pixels.size() / 3, to = result.pixels.size() / 3;
  for (std::size_t c = 0; c < 3; ++c) {
    resize_plane(std::span(image.pixels).subspan(c * from, from), image.height, image.width, part,
                 std::span(result.pixels).subspan(c * to, to), height, width);
  }
  return result;
}

RgbImage resize(const RgbImage& image, int height, int width) {
  return resize(image, all_of(image.height, image.width), height, width);
}

Plane<float> resize(const Plane<float>& plane, int height, int width) {
  return mixed(plane, all_of(plane.height, plane.width), height, width);
}

Plane<float> resize_depth(const Plane<float>& depth, const Window& part, int height, int width) {
  const bool gaps = std::find(depth.pixels.begin(), depth.pixels.end(), 0.0f) != depth.pixels.end();
  return gaps ? nearest(depth, part, height, width) : mixed(depth, part, height, width);
}

Plane<float> resize_depth(const Plane<float>& depth, int height, int width) {
  return resize_depth(depth, all_of(depth.height, depth.width), height, width);
}

Plane<std::uint32_t> resize_nearest(const Plane<std::uint32_t>& plane, const Window& part, int height,
                                    int width) {
  return nearest(plane, part, height, width);
}

Plane<std::uint32_t> resize_nearest(const Plane<std::uint32_t>& plane, int height, int width) {
  return nearest(plane, all_of(plane.height, plane.width), height, width);
}

}  // namespace vkopple
