#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/model_config.h"
#include "models/precision.h"
#include "models/rooms_config.h"
#include "models/strict_json.h"

namespace vkopple {

inline constexpr int kLargestBatch = 4096;

enum class Network { kDepth, kObject, kImagination, kMotion };
inline constexpr std::array<std::string_view, 4> kNetworkNames{"depth", "object", "imagination", "motion"};
/// Those that a model has: motion is learned in the relaxed one alone.
std::vector<Network> networks_of(const ModelConfig& model);

/// Which hypotheses of motion warp the image: every object's and the background's, or the background's alone.
enum class Hypotheses { kAll, kBackground };
inline constexpr std::array<std::string_view, 2> kHypothesesNames{"all", "background"};

/// A stretch of training. What its JSON leaves out is taken from the surrounding configuration.
struct TrainingStage {
  std::string name = "all";
  std::vector<Network> networks{Network::kDepth, Network::kObject,
                                Network::kImagination};  ///< those that learn
  Hypotheses hypotheses = Hypotheses::kAll;
  std::optional<std::int64_t> steps;  ///< absent: to the end of training; only the last stage's may be
  double learning_rate = 3e-4;
  std::int64_t warmup = 0;  ///< steps over which the learning rate grows evenly from 0
  /// To which the learning rate falls, along half a cosine over the stage's steps; absent: it stays.
  std::optional<double> final_learning_rate;
  std::optional<double> reg;            ///< in place of ModelConfig::reg
  std::optional<double> slot_contrast;  ///< in place of ModelConfig::slot_contrast
  std::optional<int> slots;  ///< in place of ModelConfig::slots, whose weights do not depend on their number
  int batch = 20;
  int accumulate = 1;  ///< portions of equal length in which the batch is worked off; see TrainingConfig
  RoomsConfig rooms;

  /// In the stage's step `step`, counted from 0.
  double learning_rate_at(std::uint64_t step) const;

  bool learns(Network network) const;
  /// The model as this stage trains it.
  ModelConfig model_in(ModelConfig model) const;
  bool operator==(const TrainingStage&) const = default;
};

/// How the model is trained: Adam with gradients clipped by value. The defaults are the published recipe.
struct TrainingConfig {
  struct Clip {
    double depth = 2.5;
    double object = 1.0;
    double imagination = 1.0;
    double motion = 1.0;
    bool operator==(const Clip&) const = default;
  };

  int batch = 20;
  /// Portions of equal length in which a batch (of several processes each one's part) is worked off one after
  /// the other, so that less of it is in memory at once; their gradients' mean makes one step.
  int accumulate = 1;
  double learning_rate = 3e-4;
  std::array<double, 2> betas{0.9, 0.999};
  double epsilon = 1e-6;
  Clip clip;
  Precision precision = Precision::kFloat32;
  bool sync_batch_norm = false;       ///< several processes: batch norms share statistics
  double reverse_probability = 0.5;   ///< of showing a triplet backwards in time
  std::vector<TrainingStage> stages;  ///< as the file lists them; see Config::stages()

  bool operator==(const TrainingConfig&) const = default;
};

/// Reads the object's members over the defaults, stages over these, `rooms` and the model's networks; throws
/// Error naming file and key.
TrainingConfig read_training_config(JsonObject object, const ModelConfig& model, const RoomsConfig& rooms);
/// Of each stage's rooms only what differs from `rooms` is written.
nlohmann::ordered_json write_training_config(const TrainingConfig& config, const RoomsConfig& rooms);

}  // namespace vkopple
