#include "tests/fuzz/fuzz.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/formats/authors/authors_table.h"

namespace vkopple::fuzz {

/// A cam_pos_….txt of the authors' recordings.
void camera_text(Input input) {
  static const test::TempFolder kFolder;
  write_file(kFolder / "cam_pos_0.txt", input);
  read_authors_texts(kFolder.path(), 1);
}

}  // namespace vkopple::fuzz
