#include "train/report/picture_rows.h"

#include <fmt/format.h>

#include "train/report/html.h"

namespace vkopple {

PictureRows::PictureRows(std::vector<std::string> headings, std::size_t narrow)
    : headings_(std::move(headings)),
      start_(fmt::format("<div class=\"pictures\" style=\"--columns: {}; --narrow: {}\">\n", headings_.size(),
                         narrow)) {
  start_ += "<div class=\"row head\" aria-hidden=\"true\">";
  for (const std::string& heading : headings_) start_ += fmt::format("<div>{}</div>", escape_html(heading));
  start_ += "</div>\n";
}

void PictureRows::add(const std::vector<RgbImage>& pictures, std::string_view name,
                      std::string_view caption_html) {
  std::string row;
  for (std::size_t i = 0; i < headings_.size(); ++i)
    row += fmt::format("<div>{}<div class=\"below\" aria-hidden=\"true\">{}</div></div>\n",
                       picture_html(pictures.at(i), fmt::format("{}: {}", name, headings_[i])),
                       escape_html(headings_[i]));
  rows_ += figure_html("<div class=\"row\">\n" + row + "</div>", caption_html);
}

std::string PictureRows::html() const { return start_ + rows_ + "</div>\n"; }

}  // namespace vkopple
