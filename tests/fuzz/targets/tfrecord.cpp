#include "train/formats/tfrecord.h"

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"

namespace vkopple::fuzz {

/// The frames round records, plain or of GZIP.
void tfrecord(Input input) {
  const InputFile file(input);
  TfRecordReader records({file.path()});
  while (records.next()) {
  }
}

}  // namespace vkopple::fuzz
