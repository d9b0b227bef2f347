#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "runtime/buffer.h"
#include "runtime/caps.h"
#include "runtime/shader_library.h"

namespace vkopple {

using Groups = std::array<uint32_t, 3>;

/// A dispatch as it was asked for; refers to what lives elsewhere.
struct Dispatch {
  std::string_view shader;
  const std::vector<uint32_t>& constants;  ///< as Recorder::dispatch takes them
  std::span<const Slice> bindings;
  uint32_t push_bytes;
  Groups groups;
};

/// Throws Error, naming what is too large and what the device allows, for a dispatch that it can't run. Shared
/// memory is not looked at. kinds: of the shader's bindings.
void require_limits(const Dispatch& dispatch, const std::vector<BindingKind>& kinds, const Caps& caps);

/// Bytes of one element of a texel buffer.
uint64_t texel_bytes(BindingKind kind, Storage storage);

}  // namespace vkopple
