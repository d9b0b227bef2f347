#include "train/exchange/example.h"

#include <span>
#include <vector>

#include "models/perception.h"
#include "train/random.h"
#include "train/safetensors.h"

namespace vkopple {

void write_example(const std::filesystem::path& path, const Device& device, const LoadedModel& model,
                   std::int64_t batch, std::uint64_t seed) {
  const ModelConfig& c = model.config.model;
  Perception perception(device, c, model.store->groups(), {.batch = batch});
  std::vector<float> images(static_cast<std::size_t>(batch * 3 * c.height * c.width));
  Random random(seed, 0);
  for (float& value : images) value = static_cast<float>(random.uniform());
  const Percepts seen = perception.see(images);
  const auto stored = [](StoredShape shape, const std::vector<float>& values) {
    return StoredTensor::of(std::move(shape), std::span(values));
  };
  write_safetensors(path, {},
                    std::map<std::string, StoredTensor>{
                        {"images", stored({batch, 3, c.height, c.width}, images)},
                        {"depth", stored({batch, 1, c.height, c.width}, seen.depth)},
                        {"masks", stored({batch, c.slots + 1, c.height, c.width}, seen.masks)},
                        {"location", stored({batch, c.slots, 3}, seen.location)},
                        {"log_pose", stored({batch, c.slots, c.bins}, seen.log_pose)}});
}

}  // namespace vkopple
