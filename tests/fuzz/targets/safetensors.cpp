#include "train/safetensors.h"

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"

namespace vkopple::fuzz {

void safetensors(Input input) {
  const InputFile stored(input);
  const SafetensorsFile file(stored.path());
  for (const std::string& name : file.names()) {
    const StoredTensor tensor = file.read(name);
    require(tensor.bytes.size() <= input.size(), "a tensor is no larger than its file");
    tolerate([&] { file.read_floats(name, tensor.shape); });
    tolerate([&] { file.read_doubles(name); });
    tolerate([&] { file.read_ints(name); });
  }
}

}  // namespace vkopple::fuzz
