#include "tests/fuzz/fuzz.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/formats/scene_reader.h"
#include "train/image_io.h"

namespace vkopple::fuzz {

/// The poses.json of a folder with one picture, a.png.
void recording(Input input) {
  static const test::TempFolder kFolder;
  static const bool kMade = [] {
    write_png(kFolder / "a.png", RgbImage(2, 3));
    return true;
  }();
  require(kMade, "a picture can be written");
  write_file(kFolder / "poses.json", input);
  const auto scenes = open_scenes(kFolder.path(), "recording");
  while (scenes->next()) {
  }
}

}  // namespace vkopple::fuzz
