#include "train/formats/example.h"

#include <array>
#include <sstream>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"
#include "train/formats/scene_reader.h"

namespace vkopple::fuzz {

/// The first byte chooses a format, the rest is a record, framed here: its checksums would keep changes out.
void example(Input input) {
  constexpr std::array<const char*, 3> kFormats{"clevr", "gqn", "movi"};
  if (input.empty()) return;
  const std::size_t format = std::to_integer<std::size_t>(input[0]) % kFormats.size();
  std::ostringstream framed;
  write_tfrecord(framed, input.subspan(1));
  const std::string text = framed.str();
  const InputFile file(std::as_bytes(std::span(text)));
  tolerate([&] {
    const auto record = TfRecordReader({file.path()}).next();
    require(record.has_value(), "a record comes back");
    Example(*record).listed();
  });
  const auto scenes = open_scenes(file.path(), kFormats[format]);
  while (scenes->next()) {
  }
}

}  // namespace vkopple::fuzz
