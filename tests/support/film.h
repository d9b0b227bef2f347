#pragma once

#include <filesystem>
#include <vector>

#include "train/image.h"

namespace vkopple::test {

/// A file of several pictures of one or more sizes, in the format of the path's ending: GIF or TIFF.
void write_film(const std::filesystem::path& path, const std::vector<RgbImage>& frames);

/// A video of pictures of one size that are not compressed, as AVI.
void write_avi(const std::filesystem::path& path, const std::vector<RgbImage>& frames);

/// Whether this build of OpenImageIO reads videos.
bool reads_videos();

}  // namespace vkopple::test
