#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "train/image.h"

namespace vkopple {

/// Rows of pictures under a line of headings; on narrow screens `narrow` in a row, each with its heading below.
class PictureRows {
 public:
  PictureRows(std::vector<std::string> headings, std::size_t narrow);

  /// A picture for each heading. `name` of the row, for those who don't see it.
  void add(const std::vector<RgbImage>& pictures, std::string_view name, std::string_view caption_html);

  std::string html() const;

 private:
  std::vector<std::string> headings_;
  std::string start_, rows_;
};

}  // namespace vkopple
