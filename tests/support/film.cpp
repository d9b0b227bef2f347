#include "tests/support/film.h"

// No fmt in this file: OpenImageIO's headers bring their own copy of it.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "train/atomic_file.h"

namespace vkopple::test {
namespace {

/// Of a pixel's channel.
uint8_t byte_of(const RgbImage& image, int c, int y, int x) {
  const auto at = (static_cast<size_t>(c * image.height + y)) * static_cast<size_t>(image.width);
  return static_cast<uint8_t>(std::lround(255 * image.pixels[at + static_cast<size_t>(x)]));
}

std::string little_endian(uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 255);
  return text;
}

std::string numbers32(const std::vector<uint32_t>& values) {
  std::string text;
  for (const uint32_t value : values) text += little_endian(value, 4);
  return text;
}

std::string chunk(const std::string& name, const std::string& content) {
  return name + little_endian(content.size(), 4) + content + std::string(content.size() % 2, '\0');
}

/// Rows from the bottom up, blue first, each filled up to a multiple of four bytes.
std::string bitmap(const RgbImage& image) {
  std::string bytes;
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x)
      for (int c = 2; c >= 0; --c) bytes += static_cast<char>(byte_of(image, c, y, x));
    bytes += std::string(static_cast<size_t>(image.width % 4), '\0');
  }
  return bytes;
}

}  // namespace

void write_film(const std::filesystem::path& path, const std::vector<RgbImage>& frames) {
  const auto out = OIIO::ImageOutput::create(path.string());
  auto mode = OIIO::ImageOutput::Create;
  for (const RgbImage& frame : frames) {
    std::vector<uint8_t> bytes;
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x)
        for (int c = 0; c < 3; ++c) bytes.push_back(byte_of(frame, c, y, x));
    const OIIO::ImageSpec spec(frame.width, frame.height, 3, OIIO::TypeDesc::UINT8);
    if (!out || !out->open(path.string(), spec, mode) || !out->write_image(OIIO::TypeDesc::UINT8, bytes.data()))
      throw std::runtime_error("cannot write " + path.string());
    mode = OIIO::ImageOutput::AppendSubimage;
  }
  if (!out->close()) throw std::runtime_error("cannot write " + path.string());
}

void write_avi(const std::filesystem::path& path, const std::vector<RgbImage>& frames) {
  constexpr uint32_t kMicroseconds = 100'000, kHasIndex = 16, kKeyFrame = 16;
  const auto count = static_cast<uint32_t>(frames.size());
  const auto width = static_cast<uint32_t>(frames.at(0).width),
             height = static_cast<uint32_t>(frames[0].height);
  std::string movie = "movi", index;
  for (const RgbImage& frame : frames) {
    const std::string picture = bitmap(frame);
    index += "00db" +
             numbers32({kKeyFrame, static_cast<uint32_t>(movie.size()), static_cast<uint32_t>(picture.size())});
    movie += chunk("00db", picture);
  }
  const auto bytes = static_cast<uint32_t>(bitmap(frames[0]).size());
  const std::string main_header =
      numbers32({kMicroseconds, 0, 0, kHasIndex, count, 0, 1, bytes, width, height, 0, 0, 0, 0});
  const std::string stream_header =
      "vids" + numbers32({0, 0, 0, 0, kMicroseconds, 1'000'000, 0, count, bytes, 0, 0, 0, 0});
  const std::string format = numbers32({40, width, height}) + little_endian(1, 2) + little_endian(24, 2) +
                             numbers32({0, bytes, 0, 0, 0, 0});
  const std::string stream = chunk("LIST", "strl" + chunk("strh", stream_header) + chunk("strf", format));
  const std::string head = chunk("LIST", "hdrl" + chunk("avih", main_header) + stream);
  write_file(path, chunk("RIFF", "AVI " + head + chunk("LIST", movie) + chunk("idx1", index)));
}

bool reads_videos() { return OIIO::get_string_attribute("format_list").find("ffmpeg") != std::string::npos; }

}  // namespace vkopple::test
