#include "train/model_store.h"

#include <fmt/format.h>

#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/transfer.h"

namespace vkopple {

ModelStore::ModelStore(const Device& device, const ModelConfig& config, Precision precision)
    : ModelStore(device, ModelLayout(config, precision)) {}

ModelStore::ModelStore(const Device& device, ModelLayout layout)
    : device_(&device), layout_(std::move(layout)), groups_(std::make_shared<GroupStore>(device)) {
  for (const std::string& name : layout_.batch_counters()) batch_counters_[name] = 0;
}

void ModelStore::initialise(uint64_t seed) {
  for (const LayoutEntry& entry : layout_.weights())
    write(entry, initial_values(entry.initial, entry.shape.elements(), seed, entry.name));
}

Slice ModelStore::slice(const LayoutEntry& entry) const {
  const Slice group = groups_->get(entry.group, layout_.groups().at(entry.group));
  return group.sub(entry.offset, static_cast<uint64_t>(entry.shape.elements()) * sizeof(float));
}

std::vector<float> ModelStore::read(const LayoutEntry& entry) const {
  return download_values<float>(*device_, slice(entry));
}

void ModelStore::write(const LayoutEntry& entry, std::span<const float> values) {
  if (static_cast<int64_t>(values.size()) != entry.shape.elements())
    throw Error(fmt::format("{}: {} values were given for the shape {}", entry.name, values.size(),
                            entry.shape.text()));
  upload_values<float>(*device_, slice(entry), values);
}

void ModelStore::count_step(bool background_only, int slots, int portions) {
  for (auto& [name, count] : batch_counters_)
    count += portions * layout_.calls_in_a_step(name, background_only, slots);
}

}  // namespace vkopple
