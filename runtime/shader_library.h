#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "runtime/caps.h"

namespace vkopple {

/// How a shader uses one binding, as its macro (shaders/include/access.glsl) says.
enum class BindingKind : uint8_t {
  kRead4,   ///< READ4: vec4 elements; a texel view or a storage buffer
  kRead1,   ///< READ1: float elements; likewise
  kReadU,   ///< READU: uint elements of a storage buffer
  kWrite4,  ///< WRITE4: vec4 elements of a storage buffer, read too where the kernel accumulates
  kWrite,   ///< WRITE1, WRITEU: likewise, elements of 32 bits
};

inline bool writes(BindingKind kind) { return kind == BindingKind::kWrite4 || kind == BindingKind::kWrite; }
/// Whether the operand may hold float16.
inline bool takes_float16(BindingKind kind) {
  return kind == BindingKind::kRead4 || kind == BindingKind::kWrite4;
}

/// Whether it is a texel buffer on that access path, else a storage buffer.
inline bool is_texel(BindingKind kind, AccessPath access) {
  return access == AccessPath::kTexel && (kind == BindingKind::kRead4 || kind == BindingKind::kRead1);
}

/// One compiled shader of the program. `name` is the file's stem, with ".variant" where the file has variants.
struct ShaderCode {
  std::string_view name;
  AccessPath access;
  std::span<const uint32_t> code;  ///< SPIR-V
};

/// Every shader that the build found. Defined by the build.
std::span<const ShaderCode> shader_library();

/// The kinds of a shader's bindings by number, read off its SPIR-V: the suffixes that the binding macros give
/// to names. Throws Error for a binding that no macro declared.
std::vector<BindingKind> binding_kinds(const ShaderCode& shader);

/// Whether the device must have CooperativeFeatures; the shader's workgroups are made of whole subgroups.
bool uses_cooperative_matrices(const ShaderCode& shader);

/// Throws Error where there is none of that name.
const ShaderCode& find_shader(std::string_view name, AccessPath access);

}  // namespace vkopple
