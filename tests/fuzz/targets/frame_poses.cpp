#include "train/frame_poses.h"

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"

namespace vkopple::fuzz {

void frame_poses(Input input) {
  const InputFile file(input);
  read_frame_poses(file.path(), {0, 1, 2}, 1.0);
}

}  // namespace vkopple::fuzz
