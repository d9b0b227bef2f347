#pragma once

#include <filesystem>

#include "models/config.h"

namespace vkopple::test {

/// A model of 16 × 16 pixels with 2 slots, whose stages are "depth" (the depth network alone) and "all".
Config tiny_config();

/// Writes a checkpoint with drawn weights, as if training had come to that stage with --data rooms:7.
void write_model(const std::filesystem::path& path, const Config& config, uint64_t stage = 1);
/// Of the model of tiny_config().
void write_tiny_model(const std::filesystem::path& path, uint64_t stage = 1);

}  // namespace vkopple::test
