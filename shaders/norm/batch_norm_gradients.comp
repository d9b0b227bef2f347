#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#define NORM_PUSH_TAIL uint flags;
#include "norm_strips.glsl"
#include "workgroup_sum.glsl"

// Second stage of batch normalisation's backward: a workgroup takes channel block x and its groups one after the other.
// With xhat = (leaky(x) - mean) * inverse over the m items of a group:
//   dbeta = sum dy', dgamma = sum dy' xhat
//   dleaky = gamma * inverse * (dy' - mean dy' - xhat * mean(dy' xhat)), in inference without the two means
// table: of batch_norm_finish. coefficients: norm_apply.backward's table.
layout(constant_id = 1) const uint kTraining = 1;
const uint kWantsGamma = 1, kWantsBeta = 2, kAccumulateGamma = 4, kAccumulateBeta = 8;
READ4(0, partials)
READ4(1, table)
WRITE4(2, coefficients)
WRITE1(3, dgamma)
WRITE1(4, dbeta)

void main() {
  uint cb = gl_WorkGroupID.x;
  bool first = gl_LocalInvocationID.x == 0;
  vec4 all = vec4(0), all_xhat = vec4(0);
  for (uint group = 0; group < p.groups; ++group) {
    uint entry = group * p.blocks + cb;
    vec4 sum = vec4(0), lost = vec4(0), product = vec4(0), product_lost = vec4(0);
    for (uint q = gl_LocalInvocationID.x; q < p.strips; q += gl_WorkGroupSize.x) {
      ADD_COMPENSATED(vec4, sum, lost, load4(partials, (entry * p.strips + q) * 2))
      ADD_COMPENSATED(vec4, product, product_lost, load4(partials, (entry * p.strips + q) * 2 + 1))
    }
    vec4 inverse = load4(table, entry * 4 + 3);
    sum = workgroup_sum(sum);
    vec4 sum_xhat = workgroup_sum(product) * inverse;
    all += sum;
    all_xhat += sum_xhat;
    if (first) {
      vec4 scale = load4(table, entry * 4 + 1);
      vec4 portion = kTraining != 0 ? scale / float(p.items) : vec4(0);
      store4(coefficients, entry * 4, load4(table, entry * 4))
      store4(coefficients, entry * 4 + 1, scale)
      store4(coefficients, entry * 4 + 2, portion * sum)
      store4(coefficients, entry * 4 + 3, portion * inverse * sum_xhat)
    }
  }
  if (!first) return;
  for (uint i = 0; i < 4; ++i) {
    uint c = cb * 4 + i;
    if (c >= p.channels) break;
    if ((p.flags & kWantsGamma) != 0) add1(dgamma, c, all_xhat[i], p.flags & kAccumulateGamma)
    if ((p.flags & kWantsBeta) != 0) add1(dbeta, c, all[i], p.flags & kAccumulateBeta)
  }
}
