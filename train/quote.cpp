#include "train/quote.h"

#include <algorithm>

namespace vkopple {

std::string one_line(std::string_view text, std::size_t longest) {
  std::string line(text.substr(0, longest));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }, '?');
  return text.size() > longest ? line + "..." : line;
}

std::string quote(std::string_view text, std::size_t longest) { return "'" + one_line(text, longest) + "'"; }

}  // namespace vkopple
