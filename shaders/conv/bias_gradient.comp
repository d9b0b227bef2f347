// variants: strip sum
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "workgroup_sum.glsl"

#ifdef STRIP
// partial[strip][co / 4] = sum of dy over the strip's pixels, which are a part of one image or some whole images; strips are
// numbered through the batch. A workgroup takes one strip of 4 channels, its invocations every local-size-th pixel.
layout(push_constant) uniform Push {
  uint images;
  uint co4;
  uint image;         // pixels
  uint strip_images;  // 1 where image_strips > 1
  uint image_strips;
  uint strip_pixels;  // of an image
} p;

READ4(0, dy)
WRITE4(1, partial)

// Of every step_-th pixel.
vec4 sum_of(uint at, uint end, uint step_) {
  vec4 sum = vec4(0);
  for (; at + 7 * step_ < end; at += 8 * step_) {
    vec4 a = (load4(dy, at) + load4(dy, at + step_)) + (load4(dy, at + 2 * step_) + load4(dy, at + 3 * step_));
    vec4 b = (load4(dy, at + 4 * step_) + load4(dy, at + 5 * step_)) +
             (load4(dy, at + 6 * step_) + load4(dy, at + 7 * step_));
    sum += a + b;
  }
  for (; at < end; at += step_) sum += load4(dy, at);
  return sum;
}

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint o = gl_WorkGroupID.x;
  uint strip = gl_WorkGroupID.y;
  uint first_image = strip / p.image_strips * p.strip_images;
  uint first = strip % p.image_strips * p.strip_pixels;
  uint end = min(first + p.strip_pixels, p.image);
  vec4 sum = vec4(0);
  for (uint n = first_image; n < min(first_image + p.strip_images, p.images); ++n) {
    uint plane = (n * p.co4 + o) * p.image;
    sum += sum_of(plane + first + lane, plane + end, gl_WorkGroupSize.x);
  }
  sum = workgroup_sum(sum);
  if (lane == 0) store4(partial, strip * p.co4 + o, sum)
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
