#include "train/picture_reader.h"

#include <algorithm>
#include <array>

#include "train/as_text.h"

namespace vkopple {
namespace {

using namespace std::string_view_literals;

struct Signature {
  std::size_t offset;
  std::string_view bytes;
  std::string_view reader;
};

/// From the formats' specifications. Longer ones of a format come before shorter ones.
constexpr std::array kSignatures{
    Signature{0, "\x89PNG\r\n\x1a\n"sv, "png"sv},
    Signature{0, "\xff\xd8\xff"sv, "jpeg"sv},
    Signature{0, "\x76\x2f\x31\x01"sv, "openexr"sv},
    Signature{0, "GIF8"sv, "gif"sv},
    Signature{0, "II*\0"sv, "tiff"sv},
    Signature{0, "MM\0*"sv, "tiff"sv},
    Signature{0, "II+\0"sv, "tiff"sv},  // more than 4 GiB
    Signature{0, "MM\0+"sv, "tiff"sv},
    Signature{8, "WEBP"sv, "webp"sv},
    Signature{0, "BM"sv, "bmp"sv},
    Signature{0, "\0\0\1\0"sv, "ico"sv},
    Signature{0, "P1"sv, "pnm"sv},
    Signature{0, "P2"sv, "pnm"sv},
    Signature{0, "P3"sv, "pnm"sv},
    Signature{0, "P4"sv, "pnm"sv},
    Signature{0, "P5"sv, "pnm"sv},
    Signature{0, "P6"sv, "pnm"sv},
    Signature{0, "PF"sv, "pnm"sv},
    Signature{0, "Pf"sv, "pnm"sv},
    Signature{0, "#?RADIANCE"sv, "hdr"sv},
    Signature{0, "#?RGBE"sv, "hdr"sv},
    Signature{0, "8BPS"sv, "psd"sv},
    Signature{0, "SDPX"sv, "dpx"sv},
    Signature{0, "XPDS"sv, "dpx"sv},
    Signature{0, "DDS "sv, "dds"sv},
    Signature{0, "\x01\xda"sv, "sgi"sv},
    Signature{4, "ftypheic"sv, "heif"sv},
    Signature{4, "ftypheix"sv, "heif"sv},
    Signature{4, "ftypmif1"sv, "heif"sv},
    Signature{4, "ftypmsf1"sv, "heif"sv},
    Signature{4, "ftypavif"sv, "heif"sv},
    Signature{4, "ftyp"sv, "ffmpeg"sv},  // MP4, MOV
    Signature{4, "moov"sv, "ffmpeg"sv},  // MOV of old
    Signature{4, "mdat"sv, "ffmpeg"sv},
    Signature{4, "wide"sv, "ffmpeg"sv},
    Signature{8, "AVI "sv, "ffmpeg"sv},
};
// Two kinds that only their endings tell: pictures with nothing at their beginning, and those of cameras, which
// begin as a TIFF does.
constexpr std::string_view kTarga = "targa";
constexpr std::string_view kRaw = "raw";
constexpr std::array kRawEndings{"arw"sv, "cr2"sv, "dng"sv, "nef"sv, "nrw"sv, "orf"sv, "pef"sv, "srw"sv};

}  // namespace

std::string_view picture_reader(std::span<const std::byte> start, std::string_view ending) {
  const std::string_view text = as_text(start.first(std::min(start.size(), kPictureStart)));
  for (const Signature& known : kSignatures) {
    if (text.size() < known.offset || !text.substr(known.offset).starts_with(known.bytes)) continue;
    const bool raw = known.reader == "tiff" && std::ranges::find(kRawEndings, ending) != kRawEndings.end();
    return raw ? kRaw : known.reader;
  }
  return ending == "tga" ? kTarga : "";
}

const std::set<std::string_view>& picture_readers() {
  static const std::set<std::string_view> kAll = [] {
    std::set<std::string_view> all{kTarga, kRaw};
    for (const Signature& known : kSignatures) all.insert(known.reader);
    return all;
  }();
  return kAll;
}

std::string small_ending(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) return "";
  std::string ending = name.substr(dot + 1);
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return ending;
}

}  // namespace vkopple
