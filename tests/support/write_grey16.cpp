#include "tests/support/write_grey16.h"

// No fmt in this file: OpenImageIO's headers bring their own copy of it.
#include <OpenImageIO/imageio.h>

#include <stdexcept>
#include <vector>

namespace vkopple::test {

void write_grey16(const std::filesystem::path& path, int width, int height, std::uint16_t value) {
  const auto out = OIIO::ImageOutput::create(path.string());
  const std::vector<std::uint16_t> pixels(static_cast<std::size_t>(width * height), value);
  if (!out || !out->open(path.string(), OIIO::ImageSpec(width, height, 1, OIIO::TypeDesc::UINT16)) ||
      !out->write_image(OIIO::TypeDesc::UINT16, pixels.data()) || !out->close())
    throw std::runtime_error("cannot write " + path.string());
}

}  // namespace vkopple::test
