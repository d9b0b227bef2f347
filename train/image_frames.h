#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "train/image.h"

namespace vkopple {

class ImageSource;

/// The pictures of a file, one after another: read as read_rgb() does (train/image_io.h), and one of most
/// files. Throws Error naming the file.
class ImageFrames {
 public:
  explicit ImageFrames(const std::filesystem::path& path);
  ~ImageFrames();
  ImageFrames(const ImageFrames&) = delete;
  ImageFrames& operator=(const ImageFrames&) = delete;

  /// Whether they are frames of one recording: an animation or a video of more than one picture, or a TIFF
  /// whose first two pages have one size. What other formats hold several of (icons, layers, parts) are other
  /// things than frames: of these the first is the only one here.
  bool film() const { return film_; }
  /// Of pictures, as the file says it without being read; none where it does not.
  std::optional<uint64_t> count() const { return count_; }

  /// None after the last, or after an Error.
  std::optional<RgbImage> next();

 private:
  bool is_film();

  std::string path_;
  std::unique_ptr<ImageSource> source_;  ///< null where nothing more comes
  std::optional<RgbImage> first_;
  bool film_ = false;
  std::exception_ptr damage_;  ///< found behind the first picture
  std::optional<uint64_t> count_;
  int index_ = 1;  ///< of the picture after the first that comes next
};

}  // namespace vkopple
