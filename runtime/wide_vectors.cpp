#include "runtime/wide_vectors.h"

#include <cstdlib>

namespace vkopple {
namespace {

/// What LLVM wants for whole registers of floats and integers alike.
bool has_wide_vectors() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
#else
  return false;
#endif
}

}  // namespace

void prefer_wide_vectors() {
  if (has_wide_vectors()) setenv("LP_NATIVE_VECTOR_WIDTH", "512", 0);
}

}  // namespace vkopple
