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
  if (!film_ || damage_) source_.reset();
}

ImageFrames::~ImageFrames() = default;

bool ImageFrames::is_film() {
  const bool movie = source_->spec().get_int_attribute("oiio:Movie") != 0;
  if (!movie && source_->format() != "tiff") return false;
  try {
    return source_->seek(1) &&
           (movie || (source_->height() == first_->height && source_->width() == first_->width));
  } catch (const Error&) {
    damage_ = std::current_exception();
    return movie;
  }
}

std::optional<RgbImage> ImageFrames::next() {
  if (first_) return std::exchange(first_, std::nullopt);
  if (damage_ && film_) std::rethrow_exception(std::exchange(damage_, nullptr));
  if (!source_) return std::nullopt;
  return guarded(path_, [&]() -> std::optional<RgbImage> {
    // Whoever asks the library for more after an end or damage gets nonsense.
    std::unique_ptr<ImageSource> source = std::move(source_);
    if (index_ > 1 && !source->seek(index_)) return std::nullopt;
    ++index_;
    RgbImage image = source->read_rgb();
    source_ = std::move(source);
    return image;
  });
}

}  // namespace vkopple
