// variants: strip sum
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

#ifdef STRIP
// partial[strip][co / 4] = sum of dy over the strip's pixels of one image; strips are numbered through the batch.
// A workgroup takes one strip of 4 channels: its invocations take every local-size-th pixel, their sums are added as a tree.
layout(push_constant) uniform Push {
  uint co4;
  uint image;  // pixels
  uint image_strips;
  uint strip_pixels;
} p;

READ4(0, dy)
WRITE4(1, partial)

shared vec4 sums[gl_WorkGroupSize.x];

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint o = gl_WorkGroupID.x;
  uint strip = gl_WorkGroupID.y;
  uint plane = (strip / p.image_strips * p.co4 + o) * p.image;
  uint at = strip % p.image_strips * p.strip_pixels;
  uint end = plane + min(at + p.strip_pixels, p.image);
  at += plane + lane;
  vec4 sum = vec4(0);
  uint step_ = gl_WorkGroupSize.x;
  for (; at + 7 * step_ < end; at += 8 * step_) {
    vec4 a = (load4(dy, at) + load4(dy, at + step_)) + (load4(dy, at + 2 * step_) + load4(dy, at + 3 * step_));
    vec4 b = (load4(dy, at + 4 * step_) + load4(dy, at + 5 * step_)) +
             (load4(dy, at + 6 * step_) + load4(dy, at + 7 * step_));
    sum += a + b;
  }
  for (; at < end; at += step_) sum += load4(dy, at);

  sums[lane] = sum;
  for (uint half_ = step_ / 2; half_ > 0; half_ /= 2) {
    barrier();
    if (lane < half_) sums[lane] += sums[lane + half_];
  }
  if (lane == 0) store4(partial, strip * p.co4 + o, sums[0])
}
#else
// db[co] (+)= sum over strips, in order, of partial[strip][co / 4]. One invocation takes 4 channels.
layout(push_constant) uniform Push {
  uint co;
  uint co4;
  uint strips;
  uint accumulate;
} p;

READ4(0, partial)
WRITE1(1, db)

void main() {
  uint o = flat_index();
  if (o >= p.co4) return;
  vec4 sum = vec4(0);
  for (uint strip = 0; strip < p.strips; ++strip) sum += load4(partial, strip * p.co4 + o);
  for (uint j = 0; j < 4; ++j)
    if (4 * o + j < p.co) add1(db, 4 * o + j, sum[j], p.accumulate)
}
#endif
