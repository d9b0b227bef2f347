#include "train/picture_reader.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "tests/support/expect_error.h"
#include "tests/support/film.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/image_files.h"
#include "train/image_io.h"

namespace vkopple::test {
namespace {

using namespace std::string_view_literals;

std::string_view reader(std::string_view start, std::string_view ending) {
  return picture_reader(std::as_bytes(std::span(start)), ending);
}

TEST(PictureReader, IsChosenByTheFirstBytes) {
  EXPECT_EQ(reader("\x89PNG\r\n\x1a\n\0\0\0\rIHDR"sv, "jpg"), "png");
  EXPECT_EQ(reader("\xff\xd8\xff\xe0"sv, ""), "jpeg");
  EXPECT_EQ(reader("RIFF\x24\0\0\0WEBPVP8 "sv, "avi"), "webp");
  EXPECT_EQ(reader("RIFF\x24\0\0\0AVI LIST"sv, "webp"), "ffmpeg");
  EXPECT_EQ(reader("\0\0\0\x1c"
                   "ftypheic"sv,
                   "mp4"),
            "heif");
  EXPECT_EQ(reader("\0\0\0\x1c"
                   "ftypisom"sv,
                   "heic"),
            "ffmpeg");
  EXPECT_EQ(reader("P6\n2 2\n255\n"sv, "mp4"), "pnm");
}

TEST(PictureReader, GoesByTheEndingWhereNothingElseTells) {
  EXPECT_EQ(reader("II*\0\x08\0\0\0"sv, "tif"), "tiff");
  EXPECT_EQ(reader("II*\0\x08\0\0\0"sv, "nef"), "raw");
  EXPECT_EQ(reader("\0\0\2\0"sv, "tga"), "targa");
  EXPECT_EQ(reader("\0\0\2\0"sv, "mp4"), "");
}

TEST(PictureReader, TextsAndWhatIsCutOffAreNoPictures) {
  for (const auto text :
       {"#EXTM3U\n#EXTINF:1,\na.ts"sv, "ffconcat version 1.0"sv, "v=0\r\nc=IN IP4 0.0.0.0"sv, "<?xml version"sv,
        "<MPD>"sv, "OggS\0\2"sv, "BAD"sv, "II*"sv, "RIFF\x24\0\0\0WEB"sv, ""sv})
    for (const char* ending : {"mp4", "gif", "m3u8", "png", ""}) EXPECT_EQ(reader(text, ending), "") << text;
}

TEST(PictureReader, EndingsAreSmall) {
  EXPECT_EQ(small_ending("a.b.JPG"), "jpg");
  EXPECT_EQ(small_ending("a"), "");
  EXPECT_EQ(small_ending("a."), "");
}

/// OpenImageIO would give the second to FFmpeg, which shows the frames of the other file.
TEST(PictureReader, ATextThatNamesAnotherFileIsNotFollowed) {
  const TempFolder folder;
  write_film(folder / "film.gif", {RgbImage(4, 4), RgbImage(4, 4)});
  EXPECT_EQ(read_rgb(folder / "film.gif").height, 4);
  for (const char* name : {"list.ffconcat", "list.mp4", "list.gif"}) {
    write_file(folder / name, "ffconcat version 1.0\nfile film.gif\n");
    expect_error([&] { read_rgb(folder / name); }, {name, "not a picture of a known format"});
  }
}

TEST(PictureReader, FoldersHoldPicturesOfKnownFormatsAlone) {
  const TempFolder folder;
  for (const char* name : {"a.PNG", "b.jpeg", "c.gif", "d.null", "e.vdb", "f.txt"})
    write_file(folder / name, "anything");
  EXPECT_EQ(image_files(folder.path()),
            (std::vector<std::filesystem::path>{folder / "a.PNG", folder / "b.jpeg", folder / "c.gif"}));
}

}  // namespace
}  // namespace vkopple::test
