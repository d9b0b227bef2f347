#pragma once

// OpenImageIO's headers bring their own copy of fmt, set up differently from ours: no fmt where this is
// included.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "runtime/error.h"
#include "train/image.h"

namespace vkopple {

std::string size_text(int height, int width);

[[noreturn]] void fail_reading(const std::string& source, const std::string& reason);

/// OpenImageIO answers most damage with a message, but some of its decoders throw.
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

/// An open file of one or more pictures, of which one is current, the first to begin with. The current one's
/// size has been checked. Throws Error naming the source.
class ImageSource {
 public:
  explicit ImageSource(const std::filesystem::path& path);
  /// `bytes` must outlive this object.
  ImageSource(std::span<const std::byte> bytes, const char* format, std::string source);

  int height() const { return image_->spec().height; }
  int width() const { return image_->spec().width; }
  std::size_t pixels() const { return static_cast<std::size_t>(height()) * static_cast<std::size_t>(width()); }
  const OIIO::ImageSpec& spec() const { return image_->spec(); }
  std::string format() const { return image_->format_name(); }

  /// Makes the picture of that index current; false after the last.
  bool seek(int index);

  /// Channels from `begin` to before `end`, interleaved.
  template <class T>
  std::vector<T> read(int begin, int end, OIIO::TypeDesc type) {
    std::vector<T> values(pixels() * static_cast<std::size_t>(end - begin));
    // Some decoders fill up what is missing, leave a message and call it a success.
    if (!image_->read_image(index_, 0, begin, end, type, values.data()) || image_->has_error()) {
      const std::string why = image_->geterror();
      fail("its pixels are damaged or cut off" + (why.empty() ? why : ": " + why));
    }
    return values;
  }

  /// All channels that a colour picture needs; grey becomes RGB.
  RgbImage read_rgb();

  /// One channel by name, which must be stored with this type. No pixels where there is none.
  template <class T>
  Plane<T> read_channel(const std::string& name, OIIO::TypeDesc type) {
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
  void open(std::span<const std::byte> bytes, const char* format);
  void check() const;

  std::string source_;
  std::vector<std::byte> content_;  ///< of a file that was checked
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;
  std::unique_ptr<OIIO::ImageInput> image_;  // after the memory it reads from
  int index_ = 0;
};

}  // namespace vkopple
