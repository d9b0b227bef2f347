#pragma once

#include <filesystem>

#include "train/run_folder.h"

namespace vkopple {

/// The checkpoint that a run goes on from: latest.safetensors or, where that is missing or damaged, of all
/// others in the folder the one with most steps that is whole. Warns of each that it passes over. Throws Error,
/// naming them, where none is left; UsageError where there never was one.
std::filesystem::path find_resume_point(const RunFolder& folder);

}  // namespace vkopple
