#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>

#include "train/rooms/renderer.h"

namespace vkopple {

/// A data set of generated rooms.
struct GenerateOptions {
  std::filesystem::path folder;  ///< gets rooms-000000.tar, ...
  uint64_t scenes = 0;
  uint64_t seed = 0;
  Lens lens;
  RoomsConfig rooms;
  std::size_t scenes_per_shard = 256;
  uint64_t pixels_at_once = uint64_t{1}
                            << 22;  ///< enough to fill a device, within the smallest binding of 128 MiB
};

/// Draws scenes 0 ... scenes - 1 of the seed and writes them as tar shards, a sample a scene (docs/data.md has
/// the format). The same options give the same bytes on the same device. `progress` (may be empty) is told how
/// many scenes are done. Throws Error: the folder holds such a data set already, no space, the options leave no
/// room for the objects.
void generate_rooms(const Device& device, const GenerateOptions& options,
                    const std::function<void(uint64_t)>& progress = {});

}  // namespace vkopple
