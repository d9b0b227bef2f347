#pragma once

#include <cstdint>
#include <filesystem>

#include "train/checkpoint.h"

namespace vkopple {

class Device;

/// Writes `batch` images of noise, functions of `seed`, with what the model sees in them on the device, to hold
/// an exported model against: a safetensors file of "images", "depth", "masks", "location" and "log_pose",
/// shaped as in export_onnx.
void write_example(const std::filesystem::path& path, const Device& device, const LoadedModel& model,
                   std::int64_t batch, std::uint64_t seed);

}  // namespace vkopple
