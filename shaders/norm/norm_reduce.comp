#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "compensated.glsl"
#include "leaky.glsl"
#include "norm_walk.glsl"
#include "random.glsl"

// First stage of the backward sums, NC4HW4: invocation q of (group z, channel block y) sums its strip.
// With dy' = dy through dropout, partials [group][block][strip][2]: sum of dy', sum of dy' (leaky(x) - mean).
// table [group][block][4] begins with the mean.
layout(constant_id = 1) const uint kDropout = 0;
READU(0, random)
READ4(1, x)
READ4(2, dy)
READ4(3, table)
WRITE4(4, partials)

struct Item {
  vec4 dy;       // through dropout
  vec4 product;  // with leaky(x) - mean
};

Item next_item(inout Walk walk, uvec2 key, vec4 mean) {
  vec4 d = load4(dy, walk.at);
  if (kDropout != 0) d *= dropout4(key, walk.at * 4, p.threshold, p.scale);
  vec4 centred = leaky(load4(x, walk.at), p.slope) - mean;
  walk_on(walk);
  return Item(d, d * centred);
}

void main() {
  uint q = gl_GlobalInvocationID.x;
  if (q >= p.strips) return;
  uint cb = gl_WorkGroupID.y, group = gl_WorkGroupID.z;
  uint count = strip_count(q);
  vec4 sum = vec4(0), lost = vec4(0), product = vec4(0), product_lost = vec4(0);
  if (count > 0) {
    uvec2 key = kDropout != 0 ? random_key(random[0], random[1], p.stream) : uvec2(0);
    vec4 mean = load4(table, (group * p.blocks + cb) * 4);
    Walk walk = walk_begin(group, cb, q);
    uint k = 0;
    for (; k + 4 <= count; k += 4) {
      Item a = next_item(walk, key, mean);
      Item b = next_item(walk, key, mean);
      Item c = next_item(walk, key, mean);
      Item d = next_item(walk, key, mean);
      ADD_COMPENSATED(vec4, sum, lost, (a.dy + b.dy) + (c.dy + d.dy))
      ADD_COMPENSATED(vec4, product, product_lost, (a.product + b.product) + (c.product + d.product))
    }
    for (; k < count; ++k) {
      Item a = next_item(walk, key, mean);
      ADD_COMPENSATED(vec4, sum, lost, a.dy)
      ADD_COMPENSATED(vec4, product, product_lost, a.product)
    }
  }
  uint out_at = ((group * p.blocks + cb) * p.strips + q) * 2;
  store4(partials, out_at, sum)
  store4(partials, out_at + 1, product)
}
