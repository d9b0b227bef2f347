#include "train/checkpoint.h"

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"
#include "train/safetensors.h"

namespace vkopple::fuzz {

/// The metadata of a checkpoint; its tensors are those of any safetensors file.
void checkpoint(Input input) {
  const InputFile stored(input);
  const CheckpointHeader header = read_checkpoint_header(stored.path());
  const CheckpointHeader again = parse_checkpoint_header(checkpoint_metadata(header), "again");
  require(again.config == header.config && again.position == header.position,
          "a checkpoint's header comes back as it was written");
}

}  // namespace vkopple::fuzz
