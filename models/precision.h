#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "runtime/storage.h"

namespace vkopple {

/// How networks keep what lies between their layers. Everything is computed and summed in float32 either way,
/// but for GPUs' products of float16 (KernelFamily::kCooperative); weights, optimiser state, statistics,
/// geometry and losses are kept in float32.
enum class Precision : uint8_t {
  kFloat32,
  kMixed,  ///< activations and their gradients in float16, the loss scaled in training
};
inline constexpr std::array<std::string_view, 2> kPrecisionNames{"float32", "mixed"};

inline Storage activation_storage(Precision precision) {
  return precision == Precision::kMixed ? Storage::kFloat16 : Storage::kFloat32;
}

}  // namespace vkopple
