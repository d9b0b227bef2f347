#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "graph/executor.h"
#include "models/model_config.h"
#include "train/model_layout.h"

namespace vkopple {

class Device;

/// The weights of a model on a device, and what training keeps beside them. Every executor that is given
/// groups() works on the same.
class ModelStore {
 public:
  /// Zeros, which is where Adam starts; the weights wait for initialise() or a checkpoint. Takes device memory
  /// for what is used, when it is first used.
  ModelStore(const Device& device, const ModelConfig& config, Precision precision = Precision::kFloat32);
  ModelStore(const Device& device, ModelLayout layout);

  /// Weights as docs/model.md §2 has them drawn.
  void initialise(uint64_t seed);

  const Device& device() const { return *device_; }
  const ModelLayout& layout() const { return layout_; }
  const std::shared_ptr<GroupStore>& groups() const { return groups_; }

  /// Row-major.
  std::vector<float> read(const LayoutEntry& entry) const;
  void write(const LayoutEntry& entry, std::span<const float> values);

  /// Calls of every batch norm so far, by the counter's name.
  std::map<std::string, int64_t>& batch_counters() { return batch_counters_; }
  const std::map<std::string, int64_t>& batch_counters() const { return batch_counters_; }
  /// Counts a step of training, each of whose portions calls batch norms.
  void count_step(bool background_only, int slots, int portions = 1);

 private:
  Slice slice(const LayoutEntry& entry) const;

  const Device* device_;
  ModelLayout layout_;
  std::shared_ptr<GroupStore> groups_;
  std::map<std::string, int64_t> batch_counters_;
};

}  // namespace vkopple
