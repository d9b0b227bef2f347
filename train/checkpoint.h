#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "models/config.h"
#include "train/model_store.h"
#include "train/training_position.h"

namespace vkopple {

// Checkpoints: safetensors files (docs/checkpoints.md). Every function throws Error naming the file, and the
// tensor or key.

/// What "format" is in a checkpoint's metadata.
inline constexpr const char* kCheckpointFormat = "vkopple checkpoint";

/// Writes everything that going on needs; the file appears when it is complete. Refuses what require_usable
/// does.
void save_checkpoint(const std::filesystem::path& path, const ModelStore& store, const Config& config,
                     const TrainingPosition& position);

/// What a checkpoint says of itself.
struct CheckpointHeader {
  Config config;
  TrainingPosition position;
};
CheckpointHeader read_checkpoint_header(const std::filesystem::path& path);
/// The same from a file's metadata, and back.
CheckpointHeader parse_checkpoint_header(const std::map<std::string, std::string>& metadata,
                                         const std::filesystem::path& path);
std::map<std::string, std::string> checkpoint_metadata(const CheckpointHeader& header);

/// Refuses values that no checkpoint may hold in a tensor of that name: such as are not finite, and negative
/// ones of a running variance, of Adam's means of squares, and of the loss scale's state.
void require_usable(const std::string& name, std::span<const float> values, const std::filesystem::path& path);

/// Fills a store with all of a checkpoint, to go on training. The checkpoint must be of this configuration.
TrainingPosition load_checkpoint(const std::filesystem::path& path, ModelStore& store, const Config& config);

/// A trained model.
struct LoadedModel {
  Config config;  ///< with as many slots as the stage had that it was last trained in
  TrainingPosition position;
  std::unique_ptr<ModelStore> store;

  /// The rooms that it was last trained on.
  RoomsConfig rooms() const;
};

/// The weights alone, for evaluation and inference, of a checkpoint or of the latest in a run's folder; the
/// file need not hold the optimiser's state.
LoadedModel load_model(const Device& device, const std::filesystem::path& path);

/// The weights alone, of such a file, into a store that waits for them. Its model must have the store's
/// tensors, all of them in their shapes; in whatever else a configuration says it may differ.
void load_weights(const std::filesystem::path& path, ModelStore& store);

}  // namespace vkopple
