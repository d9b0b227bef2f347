// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#define NORM_PUSH_TAIL float epsilon;
#include "norm_strips.glsl"
#include "workgroup_sum.glsl"

// Second stage of layer normalisation: a workgroup takes sample x (a group of one), all its channel blocks.
// Forward, from the partials of norm_statistics: table [sample][block][4] of norm_apply, its last entry 1 / deviation.
// Backward, from those of norm_reduce: with xhat = (leaky(x) - mean) * inverse over the sample's real elements,
//   dleaky = inverse * (dy' - mean dy' - xhat * mean(dy' xhat))
READ4(0, partials)
#ifdef FORWARD
WRITE4(1, table)
#else
READ4(1, table)
WRITE4(2, coefficients)
#endif

// Values of x that entry `e` of the sample's partials stands for, by lane.
vec4 weights(uint e) { return float(strip_count(e % p.strips)) * real_lanes(e / p.strips); }

float total(float v) { return workgroup_sum(vec4(v, 0, 0, 0)).x; }

void main() {
  uint entries = p.blocks * p.strips;
#ifdef FORWARD
  uint base = gl_WorkGroupID.x * entries * 3;
#else
  uint base = gl_WorkGroupID.x * entries * 2;
#endif
  uint own = gl_LocalInvocationID.x, step = gl_WorkGroupSize.x;
  float elements = float(p.items) * float(p.channels);
#ifdef FORWARD
  float origin = load4(partials, base).x;
  float sum = 0, lost = 0;
  for (uint e = own; e < entries; e += step)
    ADD_COMPENSATED(float, sum, lost, dot(weights(e), (load4(partials, base + 3 * e) - origin) + load4(partials, base + 3 * e + 2)))
  float offset = total(sum) / elements;
  precise float mean = origin + offset;
  precise float low = offset - (mean - origin);
  sum = 0;
  lost = 0;
  for (uint e = own; e < entries; e += step) {
    vec4 d = (load4(partials, base + 3 * e) - mean) + load4(partials, base + 3 * e + 2);
    vec4 squares = weights(e) * d * d + real_lanes(e / p.strips) * load4(partials, base + 3 * e + 1);
    ADD_COMPENSATED(float, sum, lost, dot(vec4(1), squares))
  }
  float inverse = 1.0 / sqrt(total(sum) / elements + p.epsilon);
#else
  float sum = 0, lost = 0, product = 0, product_lost = 0;
  for (uint e = own; e < entries; e += step) {
    ADD_COMPENSATED(float, sum, lost, dot(vec4(1), load4(partials, base + 2 * e)))
    ADD_COMPENSATED(float, product, product_lost, dot(vec4(1), load4(partials, base + 2 * e + 1)))
  }
  uint sample_entry = gl_WorkGroupID.x * p.blocks * 4;
  float mean = load4(table, sample_entry).x, inverse = load4(table, sample_entry + 3).x;
  float portion = inverse / elements;
  float shift = portion * total(sum), slant = portion * inverse * inverse * total(product);
#endif
  for (uint cb = own; cb < p.blocks; cb += step) {
    uint entry = (gl_WorkGroupID.x * p.blocks + cb) * 4;
    vec4 lanes = real_lanes(cb);
#ifdef FORWARD
    store4(table, entry, vec4(mean))
    store4(table, entry + 1, inverse * lanes)
    store4(table, entry + 2, -low * inverse * lanes)  // what the mean rounds off
    store4(table, entry + 3, vec4(inverse))
#else
    store4(coefficients, entry, vec4(mean))
    store4(coefficients, entry + 1, inverse * lanes)
    store4(coefficients, entry + 2, shift * lanes)
    store4(coefficients, entry + 3, slant * lanes)
#endif
  }
}
