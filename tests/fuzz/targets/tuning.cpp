#include "graph/conv/conv_tuning.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"
#include "tests/support/gpu_caps.h"
#include "train/tuning_file.h"

namespace vkopple::fuzz {

void tuning(Input input) {
  Caps caps = test::gpu_caps(1024, 49152, 32);
  caps.cooperative_matrices = {{16, 16, 16}};
  const InputFile file(input);
  caps.tuned = read_tuned_choices(file.path(), caps);
  if (caps.tuned == nullptr) return;
  for (const auto& [key, numbers] : *caps.tuned)
    require(is_tuned_choice(key, numbers, caps), "a choice that is taken can run on the device");
}

}  // namespace vkopple::fuzz
