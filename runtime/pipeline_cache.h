#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "runtime/caps.h"

namespace vkopple {

/// The pipeline cache's file: a header of our own (magic, version, device and driver UUIDs, driver version,
/// length, checksum) before the driver's bytes, because drivers differ in how well they check theirs.

/// Name of the cache file for a device, the same for the same device and driver.
std::string pipeline_cache_name(const Caps& caps);

/// The driver's bytes; empty where the file is absent, or damaged or another device's (then with a warning).
std::vector<std::byte> load_pipeline_cache(const std::filesystem::path& file, const Caps& caps);

/// Writes under a temporary name and renames. Failing to write is a warning, not an error: the cache only saves
/// time.
void save_pipeline_cache(const std::filesystem::path& file, const Caps& caps, std::span<const std::byte> data);

}  // namespace vkopple
