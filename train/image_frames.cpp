#include "train/image_frames.h"

#include <utility>

#include "train/image_source.h"

namespace vkopple {

ImageFrames::ImageFrames(const std::filesystem::path& path) : path_(path.string()) {
  guarded(path_, [&] {
    source_ = std::make_unique<ImageSource>(path);
    first_ = source_->read_rgb();
    film_ = is_film();
    if (const int count = source_->spec().get_int_attribute("oiio:subimages"); !film_)
      count_ = 1;
    else if (count > 1)
      count_ = static_cast<uint64_t>(count);
  });
}

ImageFrames::~ImageFrames() = default;

bool ImageFrames::is_film() {
  const bool movie = source_->spec().get_int_attribute("oiio:Movie") != 0;
  if (!movie && source_->format() != "tiff") return false;
  try {
    return source_->seek(1) &&
           (movie || (source_->height() == first_->height && source_->width() == first_->width));
  } catch (const Error&) {
    return movie;  // next() tells what is wrong, after the picture that is right
  }
}

std::optional<RgbImage> ImageFrames::next() {
  if (first_) return std::exchange(first_, std::nullopt);
  if (!film_) return std::nullopt;
  return guarded(path_, [&]() -> std::optional<RgbImage> {
    if (!source_->seek(index_)) return std::nullopt;
    ++index_;
    return source_->read_rgb();
  });
}

}  // namespace vkopple
