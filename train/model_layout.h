#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "graph/shape.h"
#include "models/initialise.h"
#include "models/model_config.h"
#include "models/precision.h"
#include "train/stored_tensor.h"

namespace vkopple {

class Graph;
class Value;
class Opple;

/// A tensor that outlives a training step, and where it lies: bytes from `offset` on of a group of a
/// GroupStore.
struct LayoutEntry {
  std::string name;  ///< in a checkpoint
  std::string group;
  uint64_t offset = 0;
  Shape shape;
  Initial initial;

  StoredShape stored_shape() const { return {shape.sizes().begin(), shape.sizes().end()}; }
};

/// Names, shapes and places of everything that training a model changes. Needs no device.
class ModelLayout {
 public:
  explicit ModelLayout(const ModelConfig& config, Precision precision = Precision::kFloat32);

  /// Parameters and running averages, by the names of docs/model.md §11.
  const std::vector<LayoutEntry>& weights() const { return weights_; }
  /// State of Adam: "adam/NETWORK/m/NAME", "adam/NETWORK/v/NAME" (its running means of gradient and squared
  /// gradient) and "adam/NETWORK/correction"; in mixed precision "loss_scale/state" too.
  const std::vector<LayoutEntry>& optimiser() const { return optimiser_; }
  /// Names of the "num_batches_tracked" of every batch norm.
  const std::vector<std::string>& batch_counters() const { return batch_counters_; }
  /// How often one step of training calls the batch norm of this counter (docs/model.md §6).
  int64_t calls_in_a_step(const std::string& counter, bool background_only, int slots) const;
  /// Bytes of the groups that hold them.
  const std::map<std::string, uint64_t>& groups() const { return groups_; }

 private:
  void add_weights(Graph& graph, const Opple& model);
  void add_loss_scale(Graph& graph, const std::vector<std::string>& networks);
  void add_optimiser(Graph& graph, const std::string& network, Value rate);

  int64_t frames_seen_;  ///< that pass depth network and mask decoder in a step of everything
  std::vector<LayoutEntry> weights_;
  std::vector<LayoutEntry> optimiser_;
  std::vector<std::string> batch_counters_;
  std::map<std::string, uint64_t> groups_;
};

}  // namespace vkopple
