#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "graph/executor.h"
#include "graph/graph.h"
#include "graph/parallel/peers.h"
#include "models/layers.h"
#include "models/model_config.h"
#include "models/object_motion.h"
#include "models/precision.h"

namespace vkopple {

/// A batch of triplets for the model.
struct Triplets {
  std::vector<float> images;          ///< 3 × (B, 3, H, W) in [0, 1]
  Slice drawn;                        ///< instead of `images`, on the device: of frames first_frame() to 2
  std::vector<CameraPose> poses;      ///< 3 × B
  std::vector<uint32_t> permutation;  ///< (B of all processes), pairs scenes for the collapse term
};

struct OppleOptions {
  int64_t batch = 1;
  bool training = false;         ///< batch statistics, dropout; otherwise running averages
  bool background_only = false;  ///< only the depth network, warping with the background hypothesis alone
  Precision precision = Precision::kFloat32;
  bool keep_stages = false;                  ///< keeps every named stage for the host (parity)
  uint64_t max_tensor_bytes = ~uint64_t{0};  ///< the device's limit (Caps::max_tensor_bytes)
  Peers* peers = nullptr;        ///< processes with parts of the same batch, `batch` each; null: this alone
  bool sync_batch_norm = false;  ///< their batch norms share statistics
};

/// The whole model on triplets (docs/model.md §1–§6): networks, matching, motion, warp, imagination, losses.
/// Builds its part of a graph and feeds its inputs.
class Opple {
 public:
  Opple(Graph& graph, const ModelConfig& config, const OppleOptions& options);

  const ModelConfig& config() const { return config_; }
  const OppleOptions& options() const { return options_; }
  Value loss() const { return loss_; }
  /// Loss terms by name: image, centre, location, pose, collapse, total.
  const std::map<std::string, Value>& losses() const { return losses_; }
  /// Parameters and running averages with what they start from.
  std::vector<InitialTensor> tensors() const;
  /// "depth", "object", "imagination", "motion", as far as the graph has them.
  std::vector<std::string> groups() const;

  Value images() const { return images_; }
  /// The first of frames 0 to 2 whose images matter.
  int first_frame() const { return options_.background_only ? 1 : 0; }
  /// Writes images, camera motion and permutation. Throws Error on sizes that don't fit.
  void feed(Executor& executor, const Triplets& triplets) const;
  /// Writes what stays: what yaw is resampled with. Once, after the executor is made.
  void feed_constants(Executor& executor) const;
  /// Sets the counters that dropout draws from.
  void feed_random(Executor& executor, uint32_t seed, uint32_t step) const;

 private:
  void declare_inputs();
  void feed_images(Executor& executor, const Triplets& triplets) const;
  void build_background_only();
  void build_all();
  std::vector<bool> seen_fully() const;
  std::vector<Value> see_depth(Value images4);
  std::vector<ObjectState> see_objects(Value images4, const std::vector<Value>& depths);
  void imagine(const ObjectState& o2, Value depth, const ObjectMotion& motion);
  void add_losses(const std::vector<ObjectState>& o, const ObjectMotion& motion, Value points2);
  void keep(const std::string& name, Value value);
  void keep_objects(const std::string& name, const ObjectState& state);
  LayerFactory& factory(const std::string& group);

  Graph* graph_;
  ModelConfig config_;
  OppleOptions options_;
  std::map<std::string, LayerFactory> factories_;
  Value images_, image2_, image3_, permutation_, random_;
  CameraMotion camera_;
  Value warped_, warped_depth_, share_, imagined_, imagined_depth_, predicted_;
  std::map<std::string, Value> losses_;
  Value loss_;
};

}  // namespace vkopple
