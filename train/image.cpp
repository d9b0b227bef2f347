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

std::vector<Share> shares(int from, int to) {
  const double scale = static_cast<double>(from) / to;
  std::vector<Share> all;
  for (int i = 0; i < to; ++i) {
    all.push_back(to < from ? area_share(i * scale, (i + 1) * scale, from)
                            : linear_share((i + 0.5) * scale, from));
  }
  return all;
}

std::size_t index(int row, int column, int width) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
}

void check_sizes(int height, int width, int new_height, int new_width) {
  if (height > 0 && width > 0 && new_height > 0 && new_width > 0) return;
  throw Error(fmt::format("an image of {}x{} can't be resized to {}x{}", height, width, new_height, new_width));
}

void resize_plane(std::span<const float> in, int height, int width, std::span<float> out, int new_height,
                  int new_width) {
  const std::vector<Share> columns = shares(width, new_width), rows = shares(height, new_height);
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

}  // namespace

RgbImage resize(const RgbImage& image, int height, int width) {
  check_sizes(image.height, image.width, height, width);
  if (image.height == height && image.width == width) return image;
  RgbImage result(height, width);
  const std::size_t from = image.pixels.size() / 3, to = result.pixels.size() / 3;
  for (std::size_t c = 0; c < 3; ++c) {
    resize_plane(std::span(image.pixels).subspan(c * from, from), image.height, image.width,
                 std::span(result.pixels).subspan(c * to, to), height, width);
  }
  return result;
}

Plane<float> resize(const Plane<float>& plane, int height, int width) {
  check_sizes(plane.height, plane.width, height, width);
  if (plane.height == height && plane.width == width) return plane;
  Plane<float> result(height, width);
  resize_plane(plane.pixels, plane.height, plane.width, result.pixels, height, width);
  return result;
}

Plane<std::uint32_t> resize_nearest(const Plane<std::uint32_t>& plane, int height, int width) {
  check_sizes(plane.height, plane.width, height, width);
  const auto source = [](int i, int from, int to) {
    return static_cast<int>((2 * static_cast<std::int64_t>(i) + 1) * from /
                            (2 * static_cast<std::int64_t>(to)));
  };
  Plane<std::uint32_t> result(height, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      result.pixels[index(y, x, width)] =
          plane.pixels[index(source(y, plane.height, height), source(x, plane.width, width), plane.width)];
    }
  }
  return result;
}

}  // namespace vkopple
