#include "tests/support/exchange_model.h"

#include <cmath>
#include <span>

#include "tests/support/tiny_model.h"
#include "train/model_layout.h"

namespace vkopple::test {

ModelWeights drawn_weights() {
  ModelWeights weights{{tiny_config(), {.step = 9, .stage = 1, .stage_step = 4, .seed = 3, .data = "rooms:7"}},
                       {}};
  const ModelLayout layout(weights.header.config.model);
  for (const LayoutEntry& entry : layout.weights()) {
    auto values = initial_values(entry.initial, entry.shape.elements(), 3, entry.name);
    if (entry.name.find("running_") != std::string::npos) {
      values = initial_values(Initial::framework(4), entry.shape.elements(), 3, entry.name);
      if (entry.name.ends_with("_var"))
        for (float& value : values) value = 0.5F + std::abs(value);
    }
    weights.tensors.emplace(entry.name, StoredTensor::of(entry.stored_shape(), std::span<const float>(values)));
  }
  std::int64_t count = 0;
  for (const std::string& name : layout.batch_counters()) {
    ++count;
    weights.tensors.emplace(name, StoredTensor::of({}, std::span<const std::int64_t>(&count, 1)));
  }
  return weights;
}

}  // namespace vkopple::test
