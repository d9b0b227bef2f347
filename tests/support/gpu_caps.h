#pragma once

#include <cstdint>

#include "runtime/caps.h"

namespace vkopple::test {

/// A made-up GPU, with Vulkan's minimum limits unless told otherwise.
inline Caps gpu_caps(uint32_t invocations = 128, uint32_t shared_bytes = 16384, uint32_t subgroup = 1) {
  Caps caps;
  caps.name = "made up";
  caps.type = DeviceType::kDiscrete;
  caps.max_workgroup_size = invocations;
  caps.shared_memory_bytes = shared_bytes;
  caps.subgroup_size = subgroup;
  caps.max_groups = {65535, 65535, 65535};
  return caps;
}

/// From Vulkan's minimum to what GPUs of today have, at every size of a subgroup.
template <class F>
void each_gpu(const F& f) {
  for (uint32_t subgroup : {1U, 2U, 4U, 8U, 16U, 32U, 64U, 128U})
    for (uint32_t invocations : {128U, 256U, 512U, 1024U})
      for (uint32_t bytes : {16384U, 32768U, 49152U, 65536U}) f(gpu_caps(invocations, bytes, subgroup));
}

}  // namespace vkopple::test
