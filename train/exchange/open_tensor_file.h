#pragma once

#include <filesystem>
#include <memory>

#include "train/tensor_file.h"

namespace vkopple {

/// A .pt or a .safetensors file; its content says which. Throws Error.
std::unique_ptr<TensorFile> open_tensor_file(const std::filesystem::path& path);

}  // namespace vkopple
