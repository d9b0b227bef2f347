#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "train/checkpoint.h"
#include "train/stored_tensor.h"
#include "train/tensor_file.h"

namespace vkopple {

/// A model's weights on the host, without a device: parameters and running averages (float32) and the counters
/// of batch norms (int64), by the names of docs/model.md §11.
struct ModelWeights {
  CheckpointHeader header;
  std::map<std::string, StoredTensor> tensors;
};

/// The weights of a checkpoint. Throws Error like load_model.
ModelWeights read_model_weights(const std::filesystem::path& checkpoint);

/// What a foreign file does not say of itself.
struct ImportOptions {
  std::optional<Config> config;            ///< of the model; needed where the file's metadata have none
  bool bgr = false;                        ///< the file's weights take and give blue, green, red
  std::vector<std::string> left_out = {};  ///< tensors whose names begin with one of these are not looked at
};

/// Weights from a file of another program, or one that export_weights has written. Numbers of any type become
/// float32; names may share the prefix "module.", which PyTorch's DataParallel puts before them; counters may
/// be absent. Throws Error naming file and tensor where one is missing, has another shape, holds what is no
/// number, or is not the model's.
ModelWeights import_weights(const TensorFile& file, const ImportOptions& options);

/// Writes a complete checkpoint from which training can go on, with Adam as at its start.
void write_model_checkpoint(const std::filesystem::path& path, const ModelWeights& weights);

/// Writes the weights alone: for PyTorch where the path ends with .pt or .pth, else as safetensors. `bgr`: with
/// colours in that order, in and out.
void export_weights(const std::filesystem::path& path, const ModelWeights& weights, bool bgr);

}  // namespace vkopple
