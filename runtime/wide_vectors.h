#pragma once

namespace vkopple {

/// Asks lavapipe for 512-bit vectors, subgroups of 16, where the processor has AVX-512: LP_NATIVE_VECTOR_WIDTH
/// is set unless the environment has it already. lavapipe reads it when the process makes its first Vulkan
/// instance, and on its own stays at 256 bits. To be called before that and before other threads are started,
/// by what works for long: large convolutions are a quarter faster, and kernels take up to twice as long to
/// compile the first time.
void prefer_wide_vectors();

}  // namespace vkopple
