#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/shader_library.h"

namespace vkopple {

/// The shader's SPIR-V with kGuardBytes added to the place of every access to a storage buffer, so that element
/// 0 lies behind a band that is bound too, and element -1 in it. Throws Error for a shader that reaches a
/// buffer otherwise than element by element.
std::vector<uint32_t> guarded_code(const ShaderCode& shader);

}  // namespace vkopple
