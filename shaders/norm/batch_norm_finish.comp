#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#define NORM_PUSH_TAIL float epsilon; float momentum;
#include "norm_strips.glsl"
#include "workgroup_sum.glsl"

// Second stage of batch normalisation: a workgroup takes channel block x and its groups one after the other.
// partials: of norm_statistics. table [group][block][4]: mean, gamma / deviation, shift, 1 / deviation, where the shift is beta
// less what the mean rounds off.
// Training moves the running averages by every group's statistics; else the table is made of them.
layout(constant_id = 1) const uint kTraining = 1;
READ4(0, partials)
READ1(1, gamma)
READ1(2, beta)
WRITE1(3, running_mean)
WRITE1(4, running_var)
WRITE4(5, table)

uint channel(uint i) { return gl_WorkGroupID.x * 4 + i; }

vec4 running(bool variance) {
  vec4 v = vec4(0);
  for (uint i = 0; i < 4; ++i)
    if (channel(i) < p.channels) v[i] = variance ? running_var[channel(i)] : running_mean[channel(i)];
  return v;
}

// Strip q's mean, as seen from `origin`.
vec4 from_origin(uint base, uint q, vec4 origin) {
  return (load4(partials, base + 3 * q) - origin) + load4(partials, base + 3 * q + 2);
}

// The mean, and in `low` what it rounds off: the distance of later values from the mean needs both.
vec4 mean_of(uint base, out vec4 low) {
  vec4 origin = load4(partials, base);
  vec4 sum = vec4(0), lost = vec4(0);
  for (uint q = gl_LocalInvocationID.x; q < p.strips; q += gl_WorkGroupSize.x)
    ADD_COMPENSATED(vec4, sum, lost, float(strip_count(q)) * from_origin(base, q, origin))
  vec4 offset = workgroup_sum(sum) / float(p.items);
  precise vec4 rounded = origin + offset;
  low = offset - (rounded - origin);
  return rounded;
}

vec4 squares_of(uint base, vec4 mean) {
  vec4 sum = vec4(0), lost = vec4(0);
  for (uint q = gl_LocalInvocationID.x; q < p.strips; q += gl_WorkGroupSize.x) {
    vec4 d = from_origin(base, q, mean);
    ADD_COMPENSATED(vec4, sum, lost, load4(partials, base + 3 * q + 1) + float(strip_count(q)) * d * d)
  }
  return workgroup_sum(sum);
}

void main() {
  uint cb = gl_WorkGroupID.x;
  bool first = gl_LocalInvocationID.x == 0;
  vec4 g = vec4(0), b = vec4(0);
  for (uint i = 0; i < 4; ++i) {
    g[i] = load1_or_zero(gamma, channel(i) < p.channels, channel(i));
    b[i] = load1_or_zero(beta, channel(i) < p.channels, channel(i));
  }
  vec4 average = running(false), average_var = running(true);
  for (uint group = 0; group < p.groups; ++group) {
    uint entry = group * p.blocks + cb;
    vec4 mean = average, variance = average_var, low = vec4(0);
    if (kTraining != 0) {
      mean = mean_of(entry * p.strips * 3, low);
      vec4 squares = squares_of(entry * p.strips * 3, mean);
      variance = squares / float(p.items);
      average += p.momentum * (mean - average);
      average_var += p.momentum * (squares / float(max(p.items - 1, 1)) - average_var);
    }
    if (first) {
      vec4 inverse = 1.0 / sqrt(variance + p.epsilon);
      store4(table, entry * 4, mean)
      store4(table, entry * 4 + 1, g * inverse)
      store4(table, entry * 4 + 2, b - low * g * inverse)
      store4(table, entry * 4 + 3, inverse)
    }
  }
  if (kTraining != 0 && first)
    for (uint i = 0; i < 4; ++i)
      if (channel(i) < p.channels) {
        running_mean[channel(i)] = average[i];
        running_var[channel(i)] = average_var[i];
      }
}
