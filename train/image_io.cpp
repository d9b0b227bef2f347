#include "train/image_io.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/image_source.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr const char* kNoDate = "1970:01:01 00:00:00";  // else the library writes the current time

std::vector<std::byte> encode(const char* format, ImageSpec& spec, TypeDesc type, const void* pixels) {
  spec.attribute("DateTime", kNoDate);
  const std::string name = std::string("memory.") + format;
  const auto output = ImageOutput::create(name);
  if (!output)
    throw Error(std::string("this build of OpenImageIO can't write ") + format + ": " +
                one_line(OIIO::geterror()));
  std::vector<unsigned char> buffer;
  OIIO::Filesystem::IOVecOutput memory(buffer);
  const bool done = output->set_ioproxy(&memory) && output->open(name, spec) &&
                    output->write_image(type, pixels) && output->close();
  if (!done) throw Error(std::string("cannot encode ") + format + ": " + one_line(output->geterror()));
  const auto bytes = std::as_bytes(std::span(buffer));
  return {bytes.begin(), bytes.end()};
}

void check_size(int height, int width, std::size_t values, std::size_t channels) {
  const bool sensible = height > 0 && width > 0 && height <= kLargestSide && width <= kLargestSide;
  if (sensible && values == channels * static_cast<std::size_t>(height) * static_cast<std::size_t>(width))
    return;
  throw Error("a picture of " + size_text(height, width) + " with " + std::to_string(values) +
              " values can't be written");
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(std::isnan(value) ? 0.0f : value, 0.0f, 1.0f)));
}

ImageSpec exr_spec(int height, int width, int channels) {
  ImageSpec spec(width, height, channels, TypeDesc::FLOAT);
  spec.attribute("compression", "zip");
  return spec;
}

std::vector<std::byte> encode_ids_exr(const Plane<std::uint32_t>& ids) {
  check_size(ids.height, ids.width, ids.pixels.size(), 1);
  ImageSpec spec = exr_spec(ids.height, ids.width, 1);
  spec.set_format(TypeDesc::UINT32);
  spec.channelnames = {"objectId"};
  return encode("exr", spec, TypeDesc::UINT32, ids.pixels.data());
}

}  // namespace

RgbImage read_rgb(const fs::path& path) {
  return guarded(path.string(), [&] {
    ImageSource input(path);
    return input.read_rgb();
  });
}

RgbImage decode_png(std::span<const std::byte> bytes, const std::string& source) {
  return guarded(source, [&] {
    ImageSource input(bytes, "png", source);
    return input.read_rgb();
  });
}

RgbImage decode_rgb(std::span<const std::byte> bytes, const std::string& source) {
  const bool jpeg = bytes.size() > 2 && bytes[0] == std::byte{0xff} && bytes[1] == std::byte{0xd8};
  return guarded(source, [&] {
    ImageSource input(bytes, jpeg ? "jpeg" : "png", source);
    return input.read_rgb();
  });
}

template <class T>
Plane<T> decode_grey(std::span<const std::byte> bytes, const std::string& source) {
  constexpr TypeDesc kType = sizeof(T) == 1 ? TypeDesc::UINT8 : TypeDesc::UINT16;
  return guarded(source, [&] {
    ImageSource input(bytes, "png", source);
    if (input.spec().nchannels != 1 || input.spec().format != kType)
      input.fail("it must have one channel of " + std::to_string(8 * sizeof(T)) + " bits");
    Plane<T> plane(input.height(), input.width());
    plane.pixels = input.read<T>(0, 1, kType);
    return plane;
  });
}
template Plane<std::uint8_t> decode_grey(std::span<const std::byte> bytes, const std::string& source);
template Plane<std::uint16_t> decode_grey(std::span<const std::byte> bytes, const std::string& source);

std::vector<std::byte> encode_png(const RgbImage& image) {
  check_size(image.height, image.width, image.pixels.size(), 3);
  const std::size_t pixels = image.pixels.size() / 3;
  std::vector<std::uint8_t> bytes(3 * pixels);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < pixels; ++i) bytes[3 * i + c] = to_byte(image.pixels[c * pixels + i]);
  }
  ImageSpec spec(image.width, image.height, 3, TypeDesc::UINT8);
  return encode("png", spec, TypeDesc::UINT8, bytes.data());
}

std::vector<std::byte> encode_png(const Plane<std::uint8_t>& plane) {
  check_size(plane.height, plane.width, plane.pixels.size(), 1);
  ImageSpec spec(plane.width, plane.height, 1, TypeDesc::UINT8);
  return encode("png", spec, TypeDesc::UINT8, plane.pixels.data());
}

std::vector<std::byte> encode_depth_exr(const Plane<float>& depth) {
  check_size(depth.height, depth.width, depth.pixels.size(), 1);
  ImageSpec spec = exr_spec(depth.height, depth.width, 1);
  spec.channelnames = {"Z"};
  spec.z_channel = 0;
  return encode("exr", spec, TypeDesc::FLOAT, depth.pixels.data());
}

std::vector<std::byte> encode_exr(const DepthAndIds& layers) {
  const auto& [depth, ids] = layers;
  if (ids.pixels.empty()) return encode_depth_exr(depth);
  if (depth.pixels.empty()) return encode_ids_exr(ids);
  check_size(depth.height, depth.width, depth.pixels.size(), 1);
  check_size(depth.height, depth.width, ids.pixels.size(), 1);
  struct Pixel {
    float depth;
    std::uint32_t id;
  };
  std::vector<Pixel> pixels;
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) pixels.push_back({depth.pixels[i], ids.pixels[i]});
  ImageSpec spec = exr_spec(depth.height, depth.width, 2);
  spec.channelnames = {"Z", "objectId"};
  spec.channelformats = {TypeDesc::FLOAT, TypeDesc::UINT32};
  spec.z_channel = 0;
  return encode("exr", spec, TypeDesc::UNKNOWN, pixels.data());  // unknown: each channel in its own type
}

DepthAndIds decode_exr(std::span<const std::byte> bytes, const std::string& source) {
  return guarded(source, [&] {
    ImageSource input(bytes, "exr", source);
    DepthAndIds layers;
    layers.depth = input.read_channel<float>("Z", TypeDesc::FLOAT);
    layers.ids = input.read_channel<std::uint32_t>("objectId", TypeDesc::UINT32);
    if (layers.depth.pixels.empty() && layers.ids.pixels.empty())
      input.fail("it has neither a channel Z nor a channel objectId");
    return layers;
  });
}

void write_png(const fs::path& path, const RgbImage& image) { write_file(path, encode_png(image)); }

void write_png(const fs::path& path, const Plane<std::uint8_t>& plane) { write_file(path, encode_png(plane)); }

void write_depth_exr(const fs::path& path, const Plane<float>& depth) {
  write_file(path, encode_depth_exr(depth));
}

}  // namespace vkopple
