#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "train/data/sample_store.h"
#include "train/rooms/renderer.h"

namespace vkopple {

/// How much of a foreign data set is taken into memory.
struct LoadLimits {
  std::uint64_t scenes = UINT64_MAX;             ///< the rest is left out
  std::uint64_t bytes = std::uint64_t{2} << 30;  ///< of encoded pictures; more is an Error
};

/// The scenes of a data set of any format that is recognised. Shards stay on disk, others are taken into
/// memory, as samples at the model's size. Throws Error, which says how to convert the data set to shards where
/// that is what helps.
std::unique_ptr<SampleStore> load_scenes(const std::filesystem::path& path, const Lens& lens,
                                         const LoadLimits& limits = {});

}  // namespace vkopple
