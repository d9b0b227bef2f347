#extension GL_EXT_control_flow_attributes : require
#include "compensated.glsl"
#include "subgroup.glsl"

// Sum over a workgroup of at most 64 invocations, always in the same order; call it in uniform control flow.
shared vec4 workgroup_values[64];

vec4 workgroup_sum(vec4 value) {
  vec4 sum = vec4(0), lost = vec4(0);
#ifdef TEXEL
  // A workgroup that is one subgroup of a CPU hands its values round: with shared memory and barriers, batch norm's
  // second stage takes two to three times as long.
  if (gl_WorkGroupSize.x == kSubgroupSize && kSubgroupSize <= kMostLanes) {
    [[unroll]] for (int i = 0; i < kMostLanes; ++i)
      if (i < int(kSubgroupSize)) ADD_COMPENSATED(vec4, sum, lost, from_lane(value, i))
    return sum;
  }
#endif
  workgroup_values[gl_LocalInvocationID.x] = value;
  barrier();
  for (uint i = 0; i < gl_WorkGroupSize.x; ++i) ADD_COMPENSATED(vec4, sum, lost, workgroup_values[i])
  barrier();
  return sum;
}
