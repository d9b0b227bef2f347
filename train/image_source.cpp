#include "train/image_source.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "train/atomic_file.h"
#include "train/exr_check.h"
#include "train/picture_reader.h"
#include "train/png_check.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;
using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr int kMaxChannels = 1024;
constexpr std::size_t kMaxCheckedBytes = std::size_t{1} << 30;
constexpr const char* kStrange = "not a picture of a known format, or a damaged one: ";

const ImageSpec& wishes() {
  static const ImageSpec kWishes = [] {
    ImageSpec spec;
    spec["oiio:UnassociatedAlpha"] = 1;  // colours as stored, not multiplied by alpha
    return spec;
  }();
  return kWishes;
}

/// The library's own reads before the first byte where a file sends it to a place below zero, as the table of
/// an EXR's lines can.
class WithinBytes : public OIIO::Filesystem::IOMemReader {
 public:
  using IOMemReader::IOMemReader;

  std::size_t read(void* to, std::size_t size) override {
    const std::size_t got = pread(to, size, m_pos);
    m_pos += static_cast<std::int64_t>(got);
    return got;
  }
  std::size_t pread(void* to, std::size_t size, std::int64_t offset) override {
    const auto end = static_cast<std::int64_t>(m_buf.size());
    if (offset < 0 || offset >= end) return 0;
    size = std::min(size, static_cast<std::size_t>(end - offset));
    std::memcpy(to, m_buf.data() + offset, size);
    return size;
  }
};

/// The reader for a file by its first bytes. Also tells a missing file from a strange one, which the library's
/// messages do not.
std::string_view reader_of(const fs::path& path) {
  const FileDescriptor file = open_for_reading(path);
  std::array<std::byte, kPictureStart> start{};
  const ssize_t got = ::read(file.get(), start.data(), start.size());
  return picture_reader(std::span(start).first(static_cast<std::size_t>(std::max<ssize_t>(got, 0))),
                        small_ending(path.filename().string()));
}

}  // namespace

std::string size_text(int height, int width) { return std::to_string(width) + "x" + std::to_string(height); }

void fail_reading(const std::string& source, const std::string& reason) {
  throw Error("cannot read " + quote(source, 4096) + ": " + one_line(reason));
}

ImageSource::ImageSource(const fs::path& path) : source_(path.string()) {
  const std::string_view reader = reader_of(path);
  if (reader.empty()) fail("not a picture of a known format");
  if (reader == "png" || reader == "openexr") {
    content_ = read_file(path, kMaxCheckedBytes);
    open(content_, reader == "png" ? "png" : "exr");
  } else {
    image_ = ImageInput::create(std::string(reader));
    if (!image_) fail("this build of OpenImageIO has no reader " + std::string(reader));
    ImageSpec ignored;
    // Whole, so that no part of a name is taken for a protocol.
    if (!image_->open(fs::absolute(path).string(), ignored, wishes())) fail(kStrange + image_->geterror());
  }
  check();
}

ImageSource::ImageSource(std::span<const std::byte> bytes, const char* format, std::string source)
    : source_(std::move(source)) {
  open(bytes, format);
  check();
}

void ImageSource::open(std::span<const std::byte> bytes, const char* format) {
  const std::string_view kind = format;
  const std::string fault = kind == "png" ? png_fault(bytes) : kind == "exr" ? exr_fault(bytes) : "";
  if (!fault.empty()) fail(fault);
  memory_ = std::make_unique<WithinBytes>(bytes.data(), bytes.size());
  image_ = ImageInput::create(format);
  ImageSpec ignored;
  if (image_ && (!image_->set_ioproxy(memory_.get()) || !image_->open(source_, ignored, wishes()))) {
    fail(kStrange + image_->geterror());
  }
}

void ImageSource::check() const {
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

bool ImageSource::seek(int index) {
  if (!image_->seek_subimage(index, 0)) {
    const std::string why = image_->geterror();
    // At the end of a TIFF the library repeats the last message about any file.
    if (why.empty() || format() == "tiff") return false;
    fail("it is damaged or cut off after " + std::to_string(index) + " images: " + why);
  }
  index_ = index;
  check();
  return true;
}

RgbImage ImageSource::read_rgb() {
  const bool grey = spec().nchannels < 3;
  const std::size_t channels = grey ? 1 : 3, count = pixels();
  const auto values = read<float>(0, static_cast<int>(channels), TypeDesc::FLOAT);
  RgbImage image(height(), width());
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < count; ++i) {
      const float value = values[i * channels + (grey ? 0 : c)];
      if (std::isnan(value)) fail("it has a pixel that is not a number");
      image.pixels[c * count + i] = std::clamp(value, 0.0f, 1.0f);
    }
  }
  return image;
}

}  // namespace vkopple
