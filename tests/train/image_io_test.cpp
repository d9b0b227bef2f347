#include "train/image_io.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;
using Bytes = std::vector<std::byte>;

RgbImage picture(int height, int width) {
  RgbImage image(height, width);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<float>(i * 37 % 256) / 255;
  return image;
}

DepthAndIds layers(int height, int width) {
  DepthAndIds both{Plane<float>(height, width), Plane<std::uint32_t>(height, width)};
  for (std::size_t i = 0; i < both.depth.pixels.size(); ++i) {
    both.depth.pixels[i] = 0.1f * static_cast<float>(i);
    both.ids.pixels[i] = static_cast<std::uint32_t>(i * 2654435761u);
  }
  return both;
}

void expect_near(const std::vector<float>& found, const std::vector<float>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-6) << i;
}

/// Any picture, written by the library itself.
void write_any(const std::filesystem::path& path, int channels, OIIO::TypeDesc type,
               const std::vector<float>& values, int height, int width) {
  const auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out);
  ASSERT_TRUE(out->open(path.string(), OIIO::ImageSpec(width, height, channels, type)));
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, values.data()));
  ASSERT_TRUE(out->close());
}

TEST(ImageIo, PngRoundTripIsExact) {
  const RgbImage image = picture(5, 7);
  const RgbImage again = decode_png(encode_png(image), "x.png");
  EXPECT_EQ(again.height, 5);
  EXPECT_EQ(again.width, 7);
  expect_near(again.pixels, image.pixels);
  EXPECT_EQ(encode_png(again), encode_png(image));
}

TEST(ImageIo, PngClampsAndRounds) {
  RgbImage image(1, 1);
  image.pixels = {-3, 2, 0.5f};
  expect_near(decode_png(encode_png(image), "x.png").pixels, {0, 1, 128.0f / 255});
  image.pixels[0] = std::nanf("");
  EXPECT_EQ(decode_png(encode_png(image), "x.png").pixels[0], 0);
}

TEST(ImageIo, ReadsManyKinds) {
  const TempFolder folder;
  using OIIO::TypeDesc;
  write_any(folder / "grey.png", 1, TypeDesc::UINT8, {0, 0.2f, 1, 0.6f}, 2, 2);
  expect_near(read_rgb(folder / "grey.png").pixels, {0, 0.2f, 1, 0.6f, 0, 0.2f, 1, 0.6f, 0, 0.2f, 1, 0.6f});
  write_any(folder / "grey_alpha.png", 2, TypeDesc::UINT8, {0.2f, 1}, 1, 1);
  EXPECT_NEAR(read_rgb(folder / "grey_alpha.png").pixels[2], 0.2f, 0.02f);
  write_any(folder / "rgba.tif", 4, TypeDesc::UINT8, {0.2f, 0.4f, 0, 0.6f}, 1, 1);
  EXPECT_EQ(read_rgb(folder / "rgba.tif").pixels.size(), 3u);
  write_any(folder / "deep.png", 3, TypeDesc::UINT16, {1.0f / 65535, 0.5f, 1}, 1, 1);
  EXPECT_NEAR(read_rgb(folder / "deep.png").pixels[0], 1.0f / 65535, 1e-9);
  write_any(folder / "float.exr", 3, TypeDesc::FLOAT, {-1, 0.25f, 7}, 1, 1);
  EXPECT_EQ(read_rgb(folder / "float.exr").pixels, (std::vector<float>{0, 0.25f, 1}));
  write_any(folder / "a.jpg", 3, TypeDesc::UINT8, std::vector<float>(3 * 64, 0.6f), 8, 8);
  EXPECT_NEAR(read_rgb(folder / "a.jpg").pixels[5], 0.6f, 0.02f);
  for (const char* name : {"a.bmp", "a.dpx", "a.hdr", "a.ico", "a.ppm", "a.sgi", "a.tga", "a.webp"}) {
    write_any(folder / name, 3, TypeDesc::UINT8, std::vector<float>(3 * 64, 0.6f), 8, 8);
    EXPECT_NEAR(read_rgb(folder / name).pixels[5], 0.6f, 0.02f) << name;
  }
}

TEST(ImageIo, AlphaDoesNotDarken) {
  const TempFolder folder;
  const auto out = OIIO::ImageOutput::create("png");
  OIIO::ImageSpec spec(1, 1, 4, OIIO::TypeDesc::UINT8);
  spec["oiio:UnassociatedAlpha"] = 1;
  const unsigned char pixel[4] = {200, 100, 50, 10};
  ASSERT_TRUE(out->open((folder / "a.png").string(), spec) && out->write_image(OIIO::TypeDesc::UINT8, pixel) &&
              out->close());
  expect_near(read_rgb(folder / "a.png").pixels, {200 / 255.0f, 100 / 255.0f, 50 / 255.0f});
}

TEST(ImageIo, ExrRoundTripIsExact) {
  const DepthAndIds both = layers(5, 7);
  const DepthAndIds again = decode_exr(encode_exr(both), "x.exr");
  EXPECT_EQ(again.depth.height, 5);
  EXPECT_EQ(again.ids.width, 7);
  EXPECT_EQ(again.depth.pixels, both.depth.pixels);
  EXPECT_EQ(again.ids.pixels, both.ids.pixels);
}

TEST(ImageIo, ExrHoldsWhatIsKnown) {
  const DepthAndIds both = layers(5, 7);
  for (const DepthAndIds& known : {both, DepthAndIds{both.depth, {}}, DepthAndIds{{}, both.ids}}) {
    const DepthAndIds again = decode_exr(encode_exr(known), "x.exr");
    EXPECT_EQ(again.depth.pixels, known.depth.pixels);
    EXPECT_EQ(again.ids.pixels, known.ids.pixels);
  }
  EXPECT_EQ(encode_exr({both.depth, {}}), encode_depth_exr(both.depth));
  expect_error([&] { encode_exr({}); }, {"can't be written"});
}

TEST(ImageIo, BytesHoldNoTime) {
  const auto text = [](const Bytes& bytes) {
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  for (const Bytes& bytes : {encode_exr(layers(5, 7)), encode_depth_exr(layers(5, 7).depth)}) {
    EXPECT_NE(text(bytes).find("1970:01:01 00:00:00"), std::string::npos);
    EXPECT_EQ(text(bytes).find("202"), std::string::npos);  // no year of these days
  }
  EXPECT_EQ(text(encode_png(picture(5, 7))).find("202"), std::string::npos);
  EXPECT_EQ(encode_png(picture(5, 7)), encode_png(picture(5, 7)));
  EXPECT_EQ(encode_exr(layers(5, 7)), encode_exr(layers(5, 7)));
}

TEST(ImageIo, WritesWholeFiles) {
  const TempFolder folder;
  Plane<std::uint8_t> mask(1, 3);
  mask.pixels = {0, 1, 255};
  write_png(folder / "mask.png", mask);
  write_png(folder / "rgb.png", picture(3, 2));
  write_depth_exr(folder / "depth.exr", layers(3, 2).depth);
  EXPECT_EQ(folder.entries(), 3u);
  EXPECT_EQ(read_rgb(folder / "mask.png").pixels[1], 1.0f / 255);
  expect_near(read_rgb(folder / "rgb.png").pixels, picture(3, 2).pixels);
  EXPECT_EQ(decode_exr(read_file(folder / "depth.exr", 1 << 20), "d").depth.pixels, layers(3, 2).depth.pixels);
}

TEST(ImageIo, RefusesEveryTruncation) {
  const Bytes png = encode_png(picture(9, 11)), exr = encode_exr(layers(9, 11));
  for (std::size_t n = 0; n + 16 < png.size(); n += 1 + n / 40) {  // the last 16 bytes hold no pixels
    expect_error([&] { decode_png(std::span(png).first(n), "cut.png"); }, {"cut.png"});
  }
  for (std::size_t n = 0; n < exr.size(); n += 1 + n / 40) {
    expect_error([&] { decode_exr(std::span(exr).first(n), "cut.exr"); }, {"cut.exr"});
  }
}

TEST(ImageIo, RefusesOtherKindsCutOff) {
  const TempFolder folder;
  for (const std::string name : {"a.jpg", "a.tif", "a.bmp", "a.exr", "a.ppm"}) {
    write_any(folder / name, 3, OIIO::TypeDesc::UINT8, picture(32, 32).pixels, 32, 32);
    EXPECT_EQ(read_rgb(folder / name).width, 32);
    std::filesystem::resize_file(folder / name, std::filesystem::file_size(folder / name) * 2 / 3);
    expect_error([&] { read_rgb(folder / name); }, {name, "cut off"});
  }
}

TEST(ImageIo, JpegInMemory) {
  const TempFolder folder;
  write_any(folder / "a.jpg", 3, OIIO::TypeDesc::UINT8, std::vector<float>(3 * 1024, 0.6f), 32, 32);
  const Bytes jpeg = read_file(folder / "a.jpg", 1 << 20);
  EXPECT_NEAR(decode_rgb(jpeg, "x.jpg").pixels[5], 0.6f, 0.02f);
  expect_error([&] { decode_rgb(std::span(jpeg).first(jpeg.size() * 2 / 3), "x.jpg"); }, {"x.jpg"});
  expect_near(decode_rgb(encode_png(picture(3, 2)), "x.png").pixels, picture(3, 2).pixels);
}

TEST(ImageIo, GreyNumbersOfAsManyBits) {
  const TempFolder folder;
  Plane<std::uint8_t> small(1, 2);
  small.pixels = {7, 255};
  EXPECT_EQ(decode_grey<std::uint8_t>(encode_png(small), "x.png").pixels, small.pixels);
  write_any(folder / "a.png", 1, OIIO::TypeDesc::UINT16, {1000.0f / 65535, 1}, 1, 2);
  const Bytes deep = read_file(folder / "a.png", 1 << 20);
  EXPECT_EQ(decode_grey<std::uint16_t>(deep, "x.png").pixels, (std::vector<std::uint16_t>{1000, 65535}));
  expect_error([&] { decode_grey<std::uint8_t>(deep, "x.png"); }, {"x.png", "one channel of 8 bits"});
  expect_error([&] { decode_grey<std::uint16_t>(encode_png(small), "x.png"); }, {"one channel of 16 bits"});
  expect_error([&] { decode_grey<std::uint8_t>(encode_png(picture(2, 2)), "x.png"); }, {"one channel"});
}

TEST(ImageIo, SurvivesEveryFlippedByte) {
  const auto flip = [](Bytes bytes, auto&& decode) {
    for (std::size_t i = 0; i < bytes.size(); i += 1 + i / 100) {
      bytes[i] ^= std::byte{0xff};
      try {
        decode(bytes);
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
      bytes[i] ^= std::byte{0xff};
    }
  };
  flip(encode_png(picture(6, 5)), [](const Bytes& bytes) { decode_png(bytes, "x.png"); });
  flip(encode_exr(layers(6, 5)), [](const Bytes& bytes) { decode_exr(bytes, "x.exr"); });
}

TEST(ImageIo, RefusesWhatIsNoPicture) {
  const TempFolder folder;
  expect_error([&] { read_rgb(folder / "none.png"); }, {"none.png", "No such file"});
  expect_error([&] { read_rgb(folder.path()); }, {"not a regular file"});
  write_file(folder / "text.png", "this is not a picture");
  expect_error([&] { read_rgb(folder / "text.png"); }, {"text.png", "not a picture"});
  write_file(folder / "text.txt", "this is not a picture");
  expect_error([&] { read_rgb(folder / "text.txt"); }, {"text.txt", "not a picture"});
  write_file(folder / "empty.exr", "");
  expect_error([&] { read_rgb(folder / "empty.exr"); }, {"empty.exr", "not a picture"});
  write_any(folder / "nan.exr", 3, OIIO::TypeDesc::FLOAT, {0, std::nanf(""), 1}, 1, 1);
  expect_error([&] { read_rgb(folder / "nan.exr"); }, {"nan.exr", "not a number"});
}

TEST(ImageIo, RefusesGiantsBeforeReading) {
  // An 8-bit grey PNG whose header claims 60000 x 50000 pixels, with a right checksum and no data.
  Bytes png = encode_png(Plane<std::uint8_t>(1, 1));
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) png[at + i] = static_cast<std::byte>(value >> (24 - 8 * i));
  };
  const auto claim = [&](std::uint32_t width, std::uint32_t height) {
    put(16, width);
    put(20, height);
    std::uint32_t crc = ~0u;
    for (std::size_t i = 12; i < 29; ++i) {
      crc ^= std::to_integer<std::uint32_t>(png[i]);
      for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xedb88320u : 0);
    }
    put(29, ~crc);
  };
  claim(60000, 50000);
  expect_error([&] { decode_png(png, "giant.png"); }, {"giant.png", "60000x50000 pixels are too many"});
  claim(16384, 16384);
  expect_error([&] { decode_png(png, "giant.png"); }, {"giant.png", "16384x16384 pixels are too many"});
  claim(1, 1);
  EXPECT_EQ(decode_png(png, "small.png").pixels.size(), 3u);
}

TEST(ImageIo, RefusesOtherExrFiles) {
  const TempFolder folder;
  write_any(folder / "rgb.exr", 3, OIIO::TypeDesc::HALF, {0, 0, 0}, 1, 1);
  const Bytes rgb = read_file(folder / "rgb.exr", 1 << 20);
  expect_error([&] { decode_exr(rgb, "rgb.exr"); }, {"rgb.exr", "neither a channel Z nor"});
  expect_error([&] { decode_exr(encode_png(picture(2, 2)), "p.exr"); }, {"p.exr"});
}

TEST(ImageIo, RefusesToWriteNonsense) {
  RgbImage image(2, 2);
  image.pixels.pop_back();
  expect_error([&] { encode_png(image); }, {"2x2", "11 values"});
  expect_error([&] { encode_exr({Plane<float>(1, 2), Plane<std::uint32_t>(2, 2)}); }, {"can't be written"});
  expect_error([&] { encode_png(Plane<std::uint8_t>()); }, {"0x0"});
}

}  // namespace
}  // namespace vkopple
