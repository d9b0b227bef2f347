#pragma once

#include <memory>
#include <vector>

#include "graph/executor.h"
#include "models/layers.h"
#include "models/model_config.h"
#include "models/object_state.h"
#include "models/precision.h"

namespace vkopple {

class Device;
struct Caps;

/// What single images show: B of them at a time, with running averages and no dropout.
struct Percepts {
  std::vector<float> depth;     ///< (B, H, W), scene units
  std::vector<float> masks;     ///< (B, K+1, H, W), background last; empty without objects
  std::vector<float> location;  ///< (B, K, 3), camera frame; empty without objects
  std::vector<float> log_pose;  ///< (B, K, bins); empty without objects or yaw
  std::vector<float> rotation;  ///< (B, K, 3, 3), object to camera; empty without objects or Euler angles
  std::vector<float> code;      ///< (B, K, code); empty without objects
};

struct PerceptionOptions {
  int64_t batch = 1;
  bool objects = true;   ///< false: depth alone
  bool profile = false;  ///< timestamps around every command
  Precision precision = Precision::kFloat32;
};

/// Bytes of device memory that a Perception takes beside the groups. Needs no device.
uint64_t perception_bytes(const Caps& caps, const ModelConfig& config, const PerceptionOptions& options);

/// The trained networks on single images. Weights and averages are those of `groups`, as training or a
/// checkpoint left them.
class Perception {
 public:
  Perception(const Device& device, const ModelConfig& config, std::shared_ptr<GroupStore> groups,
             const PerceptionOptions& options = {});

  const ModelConfig& config() const { return config_; }
  int64_t batch() const { return options_.batch; }
  /// Parameters and running averages by name, for loading.
  const std::vector<InitialTensor>& tensors() const { return tensors_; }
  Executor& executor() { return *executor_; }

  /// images: (B, 3, H, W) in [0, 1]. Throws Error on another count.
  Percepts see(std::span<const float> images);

 private:
  ModelConfig config_;
  PerceptionOptions options_;
  Graph graph_;
  std::vector<InitialTensor> tensors_;
  Value images_;
  Value depth_;
  ObjectState objects_;
  std::unique_ptr<Executor> executor_;
};

}  // namespace vkopple
