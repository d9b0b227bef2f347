#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "runtime/shader_library.h"

namespace vkopple::test {

/// What a shader asks of a device, read off its SPIR-V.
struct ShaderNeeds {
  std::set<uint32_t> capabilities;  ///< as SPIR-V numbers them
  uint64_t shared_bytes = 0;        ///< of all its variables in shared memory
};

/// constants: by constant_id, where they are not what the shader declares. Throws Error for SPIR-V that it
/// can't follow.
ShaderNeeds shader_needs(const ShaderCode& shader, const std::map<uint32_t, uint32_t>& constants);

}  // namespace vkopple::test
