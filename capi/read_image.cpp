#include "capi/read_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "runtime/error.h"

namespace vkopple::capi {
namespace {

constexpr size_t kChannels = 3;
/// As OpenImageIO scales bytes.
constexpr float kByte = 1.0F / 255.0F;

size_t value_bytes(int32_t format) {
  switch (format) {
    case VKOPPLE_RGB8:
      return 1;
    case VKOPPLE_RGB_FLOAT32:
      return sizeof(float);
    default:
      throw UsageError(
          fmt::format("the image's format is {}; it must be VKOPPLE_RGB8 or VKOPPLE_RGB_FLOAT32", format));
  }
}

void require_size(const vkopple_image& image) {
  const bool sides =
      image.height >= 1 && image.width >= 1 && image.height <= kLargestSide && image.width <= kLargestSide;
  if (!sides || int64_t{image.height} * image.width > kMostPixels)
    throw UsageError(
        fmt::format("the image has {} x {} pixels; from 1 to {} on a side and at most {} in all can be used",
                    image.width, image.height, kLargestSide, kMostPixels));
}

float value(const std::byte* at, bool bytes) {
  if (bytes) return static_cast<float>(std::to_integer<unsigned>(*at)) * kByte;
  float number = 0;
  std::memcpy(&number, at, sizeof(number));
  if (std::isnan(number)) throw Error("the image has a pixel that is not a number");
  return std::clamp(number, 0.0F, 1.0F);
}

}  // namespace

RgbImage read_image(const vkopple_image& image) {
  const size_t each = value_bytes(image.format);
  require_size(image);
  if (image.pixels == nullptr) throw UsageError("the image's pixels are a null pointer");
  const auto height = static_cast<size_t>(image.height), width = static_cast<size_t>(image.width);
  const size_t row = width * kChannels * each;
  const size_t stride = image.stride == 0 ? row : image.stride;
  if (stride < row || stride > SIZE_MAX / height)
    throw UsageError(fmt::format("the image's stride is {} bytes; a row of it has {}", stride, row));
  RgbImage rgb(image.height, image.width);
  for (size_t y = 0; y < height; ++y) {
    const auto* at = static_cast<const std::byte*>(image.pixels) + y * stride;
    for (size_t x = 0; x < width; ++x)
      for (size_t c = 0; c < kChannels; ++c, at += each)
        rgb.pixels[(c * height + y) * width + x] = value(at, each == 1);
  }
  return rgb;
}

}  // namespace vkopple::capi
