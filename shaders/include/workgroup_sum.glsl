#include "compensated.glsl"

// Sum over a workgroup of at most 64 invocations, always in the same order; call it in uniform control flow.
shared vec4 workgroup_values[64];

vec4 workgroup_sum(vec4 value) {
  workgroup_values[gl_LocalInvocationID.x] = value;
  barrier();
  vec4 sum = vec4(0), lost = vec4(0);
  for (uint i = 0; i < gl_WorkGroupSize.x; ++i) ADD_COMPENSATED(vec4, sum, lost, workgroup_values[i])
  barrier();
  return sum;
}
