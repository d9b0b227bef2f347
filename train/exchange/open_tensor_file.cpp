#include "train/exchange/open_tensor_file.h"

#include "train/exchange/stored_zip.h"
#include "train/exchange/torch_file.h"
#include "train/safetensors.h"

namespace vkopple {

std::unique_ptr<TensorFile> open_tensor_file(const std::filesystem::path& path) {
  if (is_zip(path) || has_torch_ending(path)) return std::make_unique<TorchFile>(path);
  return std::make_unique<SafetensorsFile>(path);
}

}  // namespace vkopple
