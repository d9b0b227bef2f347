#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "train/data/batch_part.h"
#include "train/data/shard_source.h"
#include "train/data/triplets.h"
#include "train/rooms/renderer.h"

namespace vkopple {

class Device;

/// What `--data` names: "rooms:SEED" draws new rooms at every step, anything else is a shard or a folder of
/// them, read ahead for training. `seed`: of the order in which shards are read then. `part`: of whole batches,
/// where `batch` triplets are one of several processes'. Throws UsageError for a seed of rooms that is no
/// number.
std::unique_ptr<TripletSource> open_triplets(const Device& device, const std::string& data, const Lens& lens,
                                             const RoomsConfig& rooms, int batch, uint64_t seed,
                                             Reading reading, BatchPart part = {});

}  // namespace vkopple
