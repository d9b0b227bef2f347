#include "train/formats/authors/authors_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/error.h"

namespace vkopple {
namespace {

using Colour = std::array<std::uint32_t, 3>;  // red, green, blue, 0 to 255

constexpr std::array<Colour, kAuthorsObjects + 1> kColours{
    {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 0}}};

Colour colour_at(const RgbImage& picture, std::size_t pixel) {
  const std::size_t area = picture.pixels.size() / 3;
  Colour colour{};
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = static_cast<std::uint32_t>(std::lround(255 * picture.pixels[c * area + pixel]));
  return colour;
}

void put(RgbImage& picture, std::size_t pixel, const Colour& colour) {
  const std::size_t area = picture.pixels.size() / 3;
  for (std::size_t c = 0; c < 3; ++c) picture.pixels[c * area + pixel] = static_cast<float>(colour[c]) / 255;
}

}  // namespace

Plane<std::uint32_t> labels_of_colours(const RgbImage& picture, const std::string& source) {
  Plane<std::uint32_t> labels(picture.height, picture.width);
  for (std::size_t i = 0; i < labels.pixels.size(); ++i) {
    const Colour colour = colour_at(picture, i);
    const auto found = std::find(kColours.begin(), kColours.end(), colour);
    if (found == kColours.end())
      throw Error(fmt::format("{}: the colour ({}, {}, {}) stands for no label; red, green, blue and yellow do",
                              source, colour[0], colour[1], colour[2]));
    labels.pixels[i] = static_cast<std::uint32_t>(found - kColours.begin());
  }
  return labels;
}

RgbImage colours_of_labels(const Plane<std::uint32_t>& labels, const std::string& source) {
  RgbImage picture(labels.height, labels.width);
  for (std::size_t i = 0; i < labels.pixels.size(); ++i) {
    if (labels.pixels[i] > kAuthorsObjects)
      throw Error(fmt::format("{}: the authors' format has at most {} objects", source, kAuthorsObjects));
    put(picture, i, kColours[labels.pixels[i]]);
  }
  return picture;
}

Plane<float> depth_of_colours(const RgbImage& picture, double unit) {
  Plane<float> depth(picture.height, picture.width);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    const Colour colour = colour_at(picture, i);
    const std::uint32_t bits = colour[2] << 16 | colour[1] << 8 | colour[0];
    depth.pixels[i] = static_cast<float>(unit * bits / 65536);
  }
  return depth;
}

RgbImage colours_of_depth(const Plane<float>& depth, double unit) {
  constexpr double kLargest = (1 << 24) - 1;
  RgbImage picture(depth.height, depth.width);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    const double wanted = std::round(depth.pixels[i] / unit * 65536);
    const auto bits = static_cast<std::uint32_t>(std::clamp(wanted, 0.0, kLargest));
    put(picture, i, {bits & 255, bits >> 8 & 255, bits >> 16});
  }
  return picture;
}

}  // namespace vkopple
