#include "runtime/wide_vectors.h"

#include <cstdlib>
#include <filesystem>
#include <string>

#include "runtime/device.h"

namespace vkopple {
namespace {

constexpr const char* kWidth = "LP_NATIVE_VECTOR_WIDTH";
constexpr const char* kKernelFolder = "MESA_SHADER_CACHE_DIR";

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
  if (has_wide_vectors()) setenv(kWidth, "512", 0);
  separate_vector_widths();
}

void separate_vector_widths() {
  const char* width = std::getenv(kWidth);
  if (width == nullptr) return;
  const char* named = std::getenv(kKernelFolder);
  const std::filesystem::path parent = named != nullptr ? named : default_cache_folder();
  const std::string own = std::string("vectors-") + width;
  if (parent.filename() == own) return;  // of a program that started this one
  if (parent.empty()) {
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    return;
  }
  std::error_code ignored;  // without a folder Mesa keeps nothing
  std::filesystem::create_directories(parent / own, ignored);
  setenv(kKernelFolder, (parent / own).c_str(), 1);
}

}  // namespace vkopple
