#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "train/data/batch_part.h"
#include "train/data/shard_source.h"
#include "train/data/triplets.h"
#include "train/rooms/renderer.h"

namespace vkopple {

class Device;

/// What of the data is read, all but `part` for data in files.
struct SourceOptions {
  Reading reading = Reading::kTraining;
  uint64_t seed = 0;             ///< of the order of training
  int threads = 2;               ///< that read ahead in training
  uint64_t scenes = UINT64_MAX;  ///< how many evaluation needs at most
  BatchPart part = {};           ///< of whole batches, where `batch` triplets are one of several processes'
  uint64_t portions = 1;         ///< batches of the source (of all processes) that make a step of training
};

/// The seed in "rooms:SEED", nothing where `data` names something else. Throws UsageError for a seed that is no
/// number.
std::optional<uint64_t> rooms_seed(const std::string& data);

/// Whether it begins as "rooms:SEED" does.
bool names_rooms(const std::string& data);

/// What `--data` names: "rooms:SEED" draws new rooms at every step, anything else is a shard or a folder of
/// them, or a data set of another known format, which is taken into memory. Throws UsageError for a seed of
/// rooms that is no number.
std::unique_ptr<TripletSource> open_triplets(const Device& device, const std::string& data, const Lens& lens,
                                             const RoomsConfig& rooms, int batch, const SourceOptions& options);

}  // namespace vkopple
