#pragma once

#include <string_view>

#include "train/stored_tensor.h"

namespace vkopple {

// Names that PyTorch's files hold, shared by reader and writer.

inline constexpr std::string_view kRebuildTensor = "torch._utils._rebuild_tensor_v2";
/// Where a file of ours keeps what it says beside its tensors; PyTorch leaves it alone.
inline constexpr std::string_view kTorchMetadataMember = "extra/vkopple.json";

struct TorchStorage {
  std::string_view name;  ///< of the class in the module torch
  StoredType dtype;
};
inline constexpr TorchStorage kTorchStorages[] = {
    {"DoubleStorage", StoredType::kF64}, {"FloatStorage", StoredType::kF32},
    {"HalfStorage", StoredType::kF16},   {"BFloat16Storage", StoredType::kBF16},
    {"LongStorage", StoredType::kI64},   {"IntStorage", StoredType::kI32},
    {"ShortStorage", StoredType::kI16},  {"CharStorage", StoredType::kI8},
    {"ByteStorage", StoredType::kU8},    {"BoolStorage", StoredType::kBool}};

}  // namespace vkopple
