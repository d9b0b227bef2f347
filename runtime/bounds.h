#pragma once

#include <cstdint>

namespace vkopple {

/// Bytes of the bands before and after every slice that a guarded recording binds; a multiple of what any
/// device wants offsets aligned to. With them added, kNowhere of row_store.glsl still lies below 2 GiB.
constexpr uint64_t kGuardBytes = 2048;

/// How far the bindings of a dispatch reach.
enum class Bounds {
  kExact,    ///< from the first byte of a slice to its last
  kGuarded,  ///< kGuardBytes further on both sides, for checks (runtime/guarded_memory.h). Texel buffers, which
             ///< give zeros outside, stay exact
};

}  // namespace vkopple
