#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// partial[strip][co][tap][ci / 4] = sum over the strip's pixels of dy[n][co][yo][xo] x[n][ci][yo stride + ky dilation - padding][...].
// A workgroup takes 4 output channels, 4 input channels, one tap and one strip of gradient pixels (numbered through the batch);
// its invocations take every local-size-th pixel, and their sums are added as a tree. Any shape; the local size is a power of 2.
layout(push_constant) uniform Push {
  uint n;
  uint ci4;
  uint h;
  uint w;
  uint co4;
  uint ho;
  uint wo;
  uint kernel;
  uint stride;
  uint padding;
  uint dilation;
  uint strip_pixels;
} p;

READ4(0, x)
READ4(1, dy)
WRITE4(2, partial)

shared vec4 sums[4 * gl_WorkGroupSize.x];

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint taps = p.kernel * p.kernel;
  uint c = gl_WorkGroupID.x % p.ci4;
  uint tap = gl_WorkGroupID.x / p.ci4;
  uint o = gl_WorkGroupID.y;
  uint strip = gl_WorkGroupID.z;
  int ky = int(tap / p.kernel * p.dilation) - int(p.padding);
  int kx = int(tap % p.kernel * p.dilation) - int(p.padding);

  mat4 sum = mat4(0);  // column j: output channel j, rows: input channels
  uint image = p.ho * p.wo;
  uint end = min((strip + 1) * p.strip_pixels, p.n * image);
  for (uint at = strip * p.strip_pixels + lane; at < end; at += gl_WorkGroupSize.x) {
    uint n = at / image;
    uint pixel = at - n * image;
    int y = int(pixel / p.wo * p.stride) + ky;
    int xx = int(pixel % p.wo * p.stride) + kx;
    if (uint(y) < p.h && uint(xx) < p.w) {
      vec4 g = load4(dy, (n * p.co4 + o) * image + pixel);
      sum += outerProduct(load4(x, ((n * p.ci4 + c) * p.h + uint(y)) * p.w + uint(xx)), g);
    }
  }

  for (uint j = 0; j < 4; ++j) sums[4 * lane + j] = sum[j];
  for (uint half_ = gl_WorkGroupSize.x / 2; half_ > 0; half_ /= 2) {
    barrier();
    if (lane < half_)
      for (uint j = 0; j < 4; ++j) sums[4 * lane + j] += sums[4 * (lane + half_) + j];
  }
  barrier();
  if (lane < 4) store4(partial, ((strip * p.co4 * 4 + o * 4 + lane) * taps + tap) * p.ci4 + c, sums[lane])
}
