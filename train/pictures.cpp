#include "train/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr float kTint = 0.55F;
constexpr int kGap = 4;
constexpr int kComfortable = 128;  // pixels of height

size_t pixel_count(const RgbImage& image) {
  return static_cast<size_t>(image.height) * static_cast<size_t>(image.width);
}

size_t offset(int y, int x, int width) {
  return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
}

/// Whether a pixel's right or lower neighbour has another label.
bool on_edge(std::span<const int32_t> labels, int height, int width, int y, int x) {
  const auto at = [&](int row, int column) { return labels[offset(row, column, width)]; };
  return (x + 1 < width && at(y, x + 1) != at(y, x)) || (y + 1 < height && at(y + 1, x) != at(y, x));
}

template <class T>
std::vector<T> enlarge_plane(std::span<const T> plane, int height, int width, int zoom) {
  std::vector<T> out;
  out.reserve(plane.size() * static_cast<size_t>(zoom) * static_cast<size_t>(zoom));
  for (int y = 0; y < height * zoom; ++y)
    for (int x = 0; x < width * zoom; ++x) out.push_back(plane[offset(y / zoom, x / zoom, width)]);
  return out;
}

void paste(RgbImage& onto, const RgbImage& picture, int top, int left) {
  for (size_t c = 0; c < 3; ++c)
    for (int y = 0; y < picture.height; ++y)
      std::copy_n(picture.pixels.begin() +
                      static_cast<std::ptrdiff_t>(c * pixel_count(picture) + offset(y, 0, picture.width)),
                  picture.width,
                  onto.pixels.begin() +
                      static_cast<std::ptrdiff_t>(c * pixel_count(onto) + offset(top + y, left, onto.width)));
}

RgbImage tint(const RgbImage& image, std::span<const int32_t> labels, int32_t background) {
  RgbImage out(image.height, image.width);
  const size_t count = pixel_count(image);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const size_t i = offset(y, x, image.width);
      const float grey =
          0.3F * image.pixels[i] + 0.59F * image.pixels[count + i] + 0.11F * image.pixels[2 * count + i];
      const auto colour = label_colour(labels[i]);
      const bool edge = on_edge(labels, image.height, image.width, y, x);
      for (size_t c = 0; c < 3; ++c) {
        const float tinted = labels[i] == background ? grey : (1 - kTint) * grey + kTint * colour[c];
        out.pixels[c * count + i] = edge ? 1.0F : tinted;
      }
    }
  return out;
}

}  // namespace

std::array<float, 3> label_colour(int index) {
  constexpr std::array<std::array<float, 3>, 12> kColours{{{0.90F, 0.10F, 0.15F},
                                                           {0.10F, 0.45F, 0.95F},
                                                           {0.15F, 0.75F, 0.25F},
                                                           {0.98F, 0.80F, 0.10F},
                                                           {0.75F, 0.20F, 0.85F},
                                                           {0.10F, 0.80F, 0.85F},
                                                           {0.98F, 0.50F, 0.10F},
                                                           {0.95F, 0.45F, 0.70F},
                                                           {0.50F, 0.35F, 0.15F},
                                                           {0.65F, 0.90F, 0.35F},
                                                           {0.30F, 0.25F, 0.60F},
                                                           {0.55F, 0.55F, 0.55F}}};
  return kColours[static_cast<size_t>(index) % kColours.size()];
}

int zoom_for(int height) { return std::max(1, (kComfortable + height - 1) / height); }

RgbImage enlarge(const RgbImage& image, int zoom) {
  RgbImage out(image.height * zoom, image.width * zoom);
  out.pixels = enlarge_plane<float>(image.pixels, 3 * image.height, image.width, zoom);
  return out;
}

RgbImage overlay(const RgbImage& image, std::span<const int32_t> labels, int32_t background, int zoom) {
  if (labels.size() != pixel_count(image)) throw Error("labels and picture have different sizes");
  return tint(enlarge(image, zoom), enlarge_plane(labels, image.height, image.width, zoom), background);
}

RgbImage depth_picture(const Plane<float>& depth, float farthest) {
  // Five stops between which colours are mixed; brightness falls evenly, so that grey prints read the same.
  constexpr std::array<std::array<float, 3>, 5> kStops{{{1.0F, 0.97F, 0.65F},
                                                        {0.99F, 0.65F, 0.25F},
                                                        {0.80F, 0.25F, 0.33F},
                                                        {0.38F, 0.10F, 0.43F},
                                                        {0.02F, 0.02F, 0.08F}}};
  RgbImage out(depth.height, depth.width);
  const size_t count = depth.pixels.size();
  for (size_t i = 0; i < count; ++i) {
    const float relative =
        std::isfinite(depth.pixels[i]) ? std::clamp(depth.pixels[i] / farthest, 0.0F, 1.0F) : 1.0F;
    const float place = relative * (static_cast<float>(kStops.size()) - 1);
    const size_t stop = std::min(static_cast<size_t>(place), kStops.size() - 2);
    const float mix = place - static_cast<float>(stop);
    for (size_t c = 0; c < 3; ++c)
      out.pixels[c * count + i] = (1 - mix) * kStops[stop][c] + mix * kStops[stop + 1][c];
  }
  return out;
}

RgbImage grey_picture(const Plane<float>& plane) {
  RgbImage image(plane.height, plane.width);
  for (size_t c = 0; c < 3; ++c)
    std::copy(plane.pixels.begin(), plane.pixels.end(),
              image.pixels.begin() + static_cast<std::ptrdiff_t>(c * plane.pixels.size()));
  return image;
}

RgbImage picture_grid(const std::vector<std::vector<RgbImage>>& rows) {
  if (rows.empty() || rows[0].empty()) throw Error("a picture grid needs at least one picture");
  const int height = rows[0][0].height;
  const int width = rows[0][0].width;
  const auto columns = static_cast<int>(rows[0].size());
  const auto count = static_cast<int>(rows.size());
  RgbImage grid(count * (height + kGap) + kGap, columns * (width + kGap) + kGap);
  std::fill(grid.pixels.begin(), grid.pixels.end(), 1.0F);
  for (int r = 0; r < count; ++r)
    for (int c = 0; c < columns; ++c) {
      const RgbImage& picture = rows[static_cast<size_t>(r)].at(static_cast<size_t>(c));
      if (picture.height != height || picture.width != width) throw Error("pictures of a grid differ in size");
      paste(grid, picture, kGap + r * (height + kGap), kGap + c * (width + kGap));
    }
  return grid;
}

}  // namespace vkopple
