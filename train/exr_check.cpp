#include "train/exr_check.h"

#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include "train/as_text.h"
#include "train/image.h"

namespace vkopple {
namespace {

constexpr std::string_view kMagic = "\x76\x2f\x31\x01";
constexpr std::uint32_t kSeveralParts = 0x1000;  // a bit of the second word
constexpr const char* kCutOff = "the EXR is cut off or damaged (a header that does not end)";

/// Of the file's machine-independent order, which is ours.
template <class Number>
Number number(std::string_view text) {
  Number value{};
  std::memcpy(&value, text.data(), sizeof value);
  return value;
}

bool is_sensible(std::int64_t width, std::int64_t height) {
  return width > 0 && height > 0 && width <= kLargestSide && height <= kLargestSide &&
         width * height <= kMostPixels;
}

/// Of the first and the last column and row.
bool is_sensible_window(std::string_view box) {
  if (box.size() != 4 * sizeof(std::int32_t)) return false;
  const auto corner = [&](std::size_t i) { return std::int64_t{number<std::int32_t>(box.substr(4 * i))}; };
  return is_sensible(corner(2) - corner(0) + 1, corner(3) - corner(1) + 1);
}

bool are_sensible_tiles(std::string_view tiles) {
  return tiles.size() == 2 * sizeof(std::uint32_t) + 1 &&
         is_sensible(number<std::uint32_t>(tiles), number<std::uint32_t>(tiles.substr(4)));
}

class HeaderWalk {
 public:
  explicit HeaderWalk(std::string_view rest) : rest_(rest) {}

  std::string fault(bool several) {
    do {
      attributes_ = 0;
      if (std::string wrong = header_fault(); !wrong.empty()) return wrong;
    } while (several && attributes_ > 0);  // a header without any ends the list
    return {};
  }

 private:
  std::string header_fault() {
    for (;; ++attributes_) {
      const auto name = take_text();
      if (!name) return kCutOff;
      if (name->empty()) return {};
      const auto type = take_text();
      if (!type || rest_.size() < sizeof(std::uint32_t)) return kCutOff;
      const auto bytes = number<std::uint32_t>(rest_);
      rest_.remove_prefix(sizeof bytes);
      if (bytes > rest_.size()) return "the EXR is cut off or damaged (an attribute is longer than the file)";
      const std::string_view value = rest_.substr(0, bytes);
      if (*name == "dataWindow" && !is_sensible_window(value)) return "the EXR's window is empty or too large";
      if (*name == "tiles" && !are_sensible_tiles(value)) return "the EXR's tiles are empty or too large";
      rest_.remove_prefix(bytes);
    }
  }

  /// Up to the next 0, which is taken too.
  std::optional<std::string_view> take_text() {
    const std::size_t end = rest_.find('\0');
    if (end == rest_.npos) return std::nullopt;
    const std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return text;
  }

  std::string_view rest_;
  std::size_t attributes_ = 0;  ///< of the header at hand
};

}  // namespace

bool looks_like_exr(std::span<const std::byte> bytes) { return as_text(bytes).starts_with(kMagic); }

std::string exr_fault(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  if (!looks_like_exr(bytes)) return "not an EXR";
  if (text.size() < 8) return kCutOff;
  return HeaderWalk(text.substr(8)).fault((number<std::uint32_t>(text.substr(4)) & kSeveralParts) != 0);
}

}  // namespace vkopple
