#include "train/image_io.h"

// OpenImageIO's headers bring their own copy of fmt, set up differently from ours: no fmt in this file.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <string_view>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/png_check.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;
using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr int kMaxChannels = 1024;
constexpr std::size_t kMaxPngBytes = std::size_t{1} << 30;
constexpr const char* kStrange = "not a picture of a known format, or a damaged one: ";
constexpr const char* kNoDate = "1970:01:01 00:00:00";  // else the library writes the current time

[[noreturn]] void fail_reading(const std::string& source, const std::string& reason) {
  throw Error("cannot read " + quote(source, 4096) + ": " + one_line(reason));
}

std::string size_text(int height, int width) { return std::to_string(width) + "x" + std::to_string(height); }

/// An open picture whose size has been checked.
class Input {
 public:
  explicit Input(const fs::path& path) : source_(path.string()) {
    image_ = ImageInput::open(source_, &wishes());
    check();
  }
  /// `bytes` must outlive this object.
  Input(std::span<const std::byte> bytes, const char* format, std::string source)
      : source_(std::move(source)),
        memory_(std::make_unique<OIIO::Filesystem::IOMemReader>(bytes.data(), bytes.size())) {
    if (std::string_view(format) == "png") {
      if (const std::string fault = png_fault(bytes); !fault.empty()) fail(fault);
    }
    image_ = ImageInput::create(format);
    ImageSpec ignored;
    if (image_ && (!image_->set_ioproxy(memory_.get()) || !image_->open(source_, ignored, wishes()))) {
      fail(kStrange + image_->geterror());
    }
    check();
  }

  int height() const { return image_->spec().height; }
  int width() const { return image_->spec().width; }
  std::size_t pixels() const { return static_cast<std::size_t>(height()) * static_cast<std::size_t>(width()); }
  const ImageSpec& spec() const { return image_->spec(); }
  const std::string& source() const { return source_; }

  /// Channels from `begin` to before `end`, interleaved.
  template <class T>
  std::vector<T> read(int begin, int end, TypeDesc type) {
    std::vector<T> values(pixels() * static_cast<std::size_t>(end - begin));
    // Some decoders fill up what is missing, leave a message and call it a success.
    if (!image_->read_image(0, 0, begin, end, type, values.data()) || image_->has_error()) {
      const std::string why = image_->geterror();
      fail("its pixels are damaged or cut off" + (why.empty() ? why : ": " + why));
    }
    return values;
  }

  /// One channel by name, which must be stored with this type. No pixels where there is none.
  template <class T>
  Plane<T> read_channel(const std::string& name, TypeDesc type) {
    const int channel = spec().channelindex(name);
    if (channel < 0) return {};
    if (spec().channelformat(channel) != type) fail("its channel " + name + " is not of type " + type.c_str());
    Plane<T> plane;
    plane.height = height();
    plane.width = width();
    plane.pixels = read<T>(channel, channel + 1, type);
    return plane;
  }

  [[noreturn]] void fail(const std::string& reason) const { fail_reading(source_, reason); }

 private:
  static const ImageSpec& wishes() {
    static const ImageSpec kWishes = [] {
      ImageSpec spec;
      spec["oiio:UnassociatedAlpha"] = 1;  // colours as stored, not multiplied by alpha
      return spec;
    }();
    return kWishes;
  }

  void check() const {
    if (!image_) fail(kStrange + OIIO::geterror());
    const ImageSpec& s = spec();
    if (s.deep || s.depth > 1) fail("deep and volume images can't be used");
    if (s.width < 1 || s.height < 1 || s.nchannels < 1 || s.nchannels > kMaxChannels)
      fail("it has no usable pixels");
    if (s.width > kLargestSide || s.height > kLargestSide || std::int64_t{s.width} * s.height > kMostPixels) {
      fail(size_text(s.height, s.width) + " pixels are too many; make it smaller, at most " +
           std::to_string(kLargestSide) + " a side and " + std::to_string(kMostPixels) + " in all");
    }
  }

  std::string source_;
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;
  std::unique_ptr<ImageInput> image_;  // after the memory it reads from
};

/// The library answers most damage with a message, but some of its decoders throw.
template <class Read>
auto guarded(const std::string& source, Read&& read) {
  try {
    return read();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& problem) {
    fail_reading(source, problem.what());
  }
}

/// Also tells a missing file from a strange one, which the library's messages do not.
bool starts_as_png(const fs::path& path) {
  const FileDescriptor file = open_for_reading(path);
  std::array<std::byte, 8> start{};
  return ::read(file.get(), start.data(), start.size()) == 8 && looks_like_png(start);
}

RgbImage to_rgb(Input& input) {
  const bool grey = input.spec().nchannels < 3;
  const std::size_t channels = grey ? 1 : 3, pixels = input.pixels();
  const auto values = input.read<float>(0, static_cast<int>(channels), TypeDesc::FLOAT);
  RgbImage image(input.height(), input.width());
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < pixels; ++i) {
      const float value = values[i * channels + (grey ? 0 : c)];
      if (std::isnan(value)) input.fail("it has a pixel that is not a number");
      image.pixels[c * pixels + i] = std::clamp(value, 0.0f, 1.0f);
    }
  }
  return image;
}

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
    std::vector<std::byte> png;
    if (starts_as_png(path)) png = read_file(path, kMaxPngBytes);
    Input input = png.empty() ? Input(path) : Input(png, "png", path.string());
    return to_rgb(input);
  });
}

RgbImage decode_png(std::span<const std::byte> bytes, const std::string& source) {
  return guarded(source, [&] {
    Input input(bytes, "png", source);
    return to_rgb(input);
  });
}

RgbImage decode_rgb(std::span<const std::byte> bytes, const std::string& source) {
  const bool jpeg = bytes.size() > 2 && bytes[0] == std::byte{0xff} && bytes[1] == std::byte{0xd8};
  return guarded(source, [&] {
    Input input(bytes, jpeg ? "jpeg" : "png", source);
    return to_rgb(input);
  });
}

template <class T>
Plane<T> decode_grey(std::span<const std::byte> bytes, const std::string& source) {
  constexpr TypeDesc kType = sizeof(T) == 1 ? TypeDesc::UINT8 : TypeDesc::UINT16;
  return guarded(source, [&] {
    Input input(bytes, "png", source);
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
    Input input(bytes, "exr", source);
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
