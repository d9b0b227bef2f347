#include "runtime/dispatch.h"

#include <fmt/format.h>

#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr const char* kAdvice = "use a smaller --batch or image size";

void require_workgroup(const Dispatch& d, const Caps& caps) {
  const uint32_t invocations = d.constants.empty() ? 0 : d.constants[0];
  if (invocations == 0 || invocations > caps.max_workgroup_size)
    throw Error(
        fmt::format("shader {} needs workgroups of {} invocations, {} allows {}; leave the choice of "
                    "kernels to the device",
                    d.shader, invocations, caps.name, caps.max_workgroup_size));
  for (size_t i = 0; i < d.groups.size(); ++i)
    if (d.groups[i] > caps.max_groups[i])
      throw Error(fmt::format("shader {} needs {} workgroups in one direction, {} allows {}; {}", d.shader,
                              d.groups[i], caps.name, caps.max_groups[i], kAdvice));
}

}  // namespace

uint64_t texel_bytes(BindingKind kind, Storage storage) {
  return element_bytes(storage) * (kind == BindingKind::kRead4 ? 4 : 1);
}

void require_limits(const Dispatch& d, const std::vector<BindingKind>& kinds, const Caps& caps) {
  if (d.bindings.size() != kinds.size())
    throw Error(
        fmt::format("shader {} has {} bindings, {} were given", d.shader, kinds.size(), d.bindings.size()));
  require_workgroup(d, caps);
  for (size_t i = 0; i < kinds.size(); ++i) {
    const Slice& slice = d.bindings[i];
    if (!slice) continue;
    if (slice.storage == Storage::kFloat16 && !takes_float16(kinds[i]))
      throw Error(fmt::format(
          "shader {}: operand {} is float16, which is read and written by vectors of four channels only",
          d.shader, i));
    const uint64_t most = is_texel(kinds[i], caps.access)
                              ? caps.max_texel_elements * texel_bytes(kinds[i], slice.storage)
                              : caps.max_storage_range;
    if (slice.bytes > most)
      throw Error(fmt::format("shader {}: operand {} has {} MiB, {} binds at most {} MiB; {}", d.shader, i,
                              (slice.bytes + (1U << 20) - 1) >> 20, caps.name, most >> 20, kAdvice));
  }
}

}  // namespace vkopple
