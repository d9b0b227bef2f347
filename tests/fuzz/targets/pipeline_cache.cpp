#include "runtime/pipeline_cache.h"

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"

namespace vkopple::fuzz {

void pipeline_cache(Input input) {
  const InputFile file(input);
  require(load_pipeline_cache(file.path(), Caps{}).size() <= input.size(),
          "what is read is no larger than the file");
}

}  // namespace vkopple::fuzz
