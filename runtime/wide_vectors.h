#pragma once

namespace vkopple {

/// Asks lavapipe for 512-bit vectors, subgroups of 16, where the processor has AVX-512: LP_NATIVE_VECTOR_WIDTH
/// is set unless the environment has it already. lavapipe reads it when the process makes its first Vulkan
/// instance, and on its own stays at 256 bits. To be called before that and before other threads are started,
/// by what works for long: large convolutions are a quarter faster, and kernels take up to twice as long to
/// compile the first time.
void prefer_wide_vectors();

/// Has Mesa keep what it compiles for a width that LP_NATIVE_VECTOR_WIDTH asks for in a folder of its own, by
/// MESA_SHADER_CACHE_DIR: "vectors-512" in the folder that this names already, else in default_cache_folder().
/// Mesa finds compiled code again by keys that leave the width out, and kernels of Mesa 25.0.7 that call code
/// of another width crash or read NaN (docs/devices.md). Changes nothing where no width is asked for.
/// prefer_wide_vectors() does it too; to be called as early as that.
void separate_vector_widths();

}  // namespace vkopple
