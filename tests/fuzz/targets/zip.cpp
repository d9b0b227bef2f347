#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"
#include "train/exchange/open_tensor_file.h"
#include "train/exchange/stored_zip.h"

namespace vkopple::fuzz {

void zip(Input input) {
  const InputFile file(input);
  tolerate([&] {
    std::size_t bytes = 0;
    for (const auto& [name, member] : read_stored_zip(file.path())) bytes += member.size();
    require(bytes <= input.size(), "the members together are no larger than the file");
  });
  open_tensor_file(file.path());
}

}  // namespace vkopple::fuzz
