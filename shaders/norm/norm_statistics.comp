#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "leaky.glsl"
#include "norm_walk.glsl"

// First stage of mean and variance of leaky(x), NC4HW4: invocation q of (group z, channel block y) sums its strip.
// partials [group][block][strip][2]: the strip's mean, and its sum of squared distances from that mean. Distances are taken from
// the strip's first item, so that a mean far from 0 costs no digits.
READ4(0, x)
WRITE4(1, partials)

void main() {
  uint q = gl_GlobalInvocationID.x;
  if (q >= p.strips) return;
  uint cb = gl_WorkGroupID.y, group = gl_WorkGroupID.z;
  uint count = strip_count(q);
  vec4 mean = vec4(0), squares = vec4(0);
  if (count > 0) {
    Walk walk = walk_begin(group, cb, q);
    uint origin_at = walk.at;
    vec4 origin = leaky(load4(x, origin_at), p.slope);
    vec4 sum[4] = vec4[4](vec4(0), vec4(0), vec4(0), vec4(0));
    vec4 sum2[4] = sum;
    for (uint k = 0; k < count; k += 4)
      for (uint j = 0; j < 4; ++j) {
        // Beyond the end, the first item again: it adds exactly 0.
        vec4 d = leaky(load4(x, k + j < count ? walk.at : origin_at), p.slope) - origin;
        sum[j] += d;
        sum2[j] += d * d;
        walk_on(walk);
      }
    vec4 total = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    vec4 total2 = (sum2[0] + sum2[1]) + (sum2[2] + sum2[3]);
    mean = origin + total / float(count);
    squares = max(total2 - total * total / float(count), vec4(0));
  }
  uint out_at = ((group * p.blocks + cb) * p.strips + q) * 2;
  store4(partials, out_at, mean)
  store4(partials, out_at + 1, squares)
}
