#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "compensated.glsl"
#include "leaky.glsl"
#include "norm_walk.glsl"
#include "product_remainder.glsl"

// First stage of mean and variance of leaky(x), NC4HW4: invocation q of (group z, channel block y) sums its strip.
// partials [group][block][strip][3]: the strip's mean, its sum of squared distances from that mean, and what the mean
// rounds off. Distances are taken from the strip's first item, so that a mean far from 0 costs no digits.
// Fours are summed plainly, which is faster and costs at most some roundings of a four, and their sums compensated.
READ4(0, x)
WRITE4(1, partials)

// The item's distance from the origin; walks on.
vec4 item(inout Walk walk, vec4 origin) {
  vec4 d = leaky(load4(x, walk.at), p.slope) - origin;
  walk_on(walk);
  return d;
}

void main() {
  uint q = gl_GlobalInvocationID.x;
  if (q >= p.strips) return;
  uint cb = gl_WorkGroupID.y, group = gl_WorkGroupID.z;
  uint count = strip_count(q);
  vec4 mean = vec4(0), squares = vec4(0), mean_low = vec4(0);
  if (count > 0) {
    Walk walk = walk_begin(group, cb, q);
    uint origin_at = walk.at;
    vec4 origin = leaky(load4(x, origin_at), p.slope);
    vec4 sum = vec4(0), lost = vec4(0), sum2 = vec4(0), lost2 = vec4(0);
    uint k = 0;
    for (; k + 4 <= count; k += 4) {
      vec4 d0 = item(walk, origin);
      vec4 d1 = item(walk, origin);
      vec4 d2 = item(walk, origin);
      vec4 d3 = item(walk, origin);
      ADD_COMPENSATED(vec4, sum, lost, (d0 + d1) + (d2 + d3))
      ADD_COMPENSATED(vec4, sum2, lost2, (d0 * d0 + d1 * d1) + (d2 * d2 + d3 * d3))
    }
    for (; k < count; ++k) {
      vec4 d = item(walk, origin);
      ADD_COMPENSATED(vec4, sum, lost, d)
      ADD_COMPENSATED(vec4, sum2, lost2, d * d)
    }
    vec4 offset = sum / float(count);
    precise vec4 rounded = origin + offset;
    precise vec4 low = offset - (rounded - origin);
    mean = rounded;
    mean_low = low;
    // What the product rounds off matters where the first item lies far from the mean.
    precise vec4 product = sum * offset;
    vec4 rounded_off = product_remainder(sum, offset, product);
    squares = max((sum2 - product) - (rounded_off + lost2), vec4(0));
  }
  uint out_at = ((group * p.blocks + cb) * p.strips + q) * 3;
  store4(partials, out_at, mean)
  store4(partials, out_at + 1, squares)
  store4(partials, out_at + 2, mean_low)
}
