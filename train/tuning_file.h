#pragma once

#include <filesystem>
#include <memory>

#include "runtime/caps.h"

namespace vkopple {

/// Where a device's and driver's tuned choices lie: tuning-UUID-VERSION.json in the cache folder; empty where
/// no cache folder is known.
std::filesystem::path tuning_file(const Caps& caps);

/// What `vkopple tune` left. The file is not trusted: a damaged one, or that of
/// another device or driver, is ignored with a warning, and so is every choice that this program doesn't know
/// or the device can't run. Null where nothing is left.
std::shared_ptr<const TunedChoices> read_tuned_choices(const std::filesystem::path& file, const Caps& caps);
/// The same from the device's own file: for DeviceOptions::tuned.
std::shared_ptr<const TunedChoices> load_tuned_choices(const Caps& caps);

/// Writes the file atomically, making its folder. Throws Error where it can't.
void save_tuned_choices(const std::filesystem::path& file, const Caps& caps, const TunedChoices& choices);

}  // namespace vkopple
