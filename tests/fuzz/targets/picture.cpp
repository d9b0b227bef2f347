#include "tests/fuzz/fuzz.h"
#include "train/image_io.h"

namespace vkopple::fuzz {

/// Pictures of shards and records, of every kind.
void picture(Input input) {
  tolerate([&] { decode_png(input, "input"); });
  tolerate([&] { decode_rgb(input, "input"); });
  tolerate([&] { decode_grey<std::uint16_t>(input, "input"); });
  decode_exr(input, "input");
}

}  // namespace vkopple::fuzz
