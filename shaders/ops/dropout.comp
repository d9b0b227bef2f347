#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "random.glsl"

// y = x * mask / (1 - rate); the gradient is the same function of dy. One invocation takes 8 quads of words, a workgroup a
// contiguous run of them.
layout(constant_id = 1) const uint kVectors = 1;  // 1: the number of words is a multiple of 4
layout(push_constant) uniform Push {
  uint words;
  uint stream;
  uint threshold;
  float scale;
  uint accumulate;
} p;
READU(0, random)
READ4(1, x4)
WRITE4(2, y4)
READ1(3, x1)
WRITE1(4, y1)

const uint kQuads = 8;

void main() {
  uvec2 key = random_key(random[0], random[1], p.stream);
  uint local = gl_WorkGroupSize.x;
  uint quad = (flat_index() - gl_LocalInvocationID.x) * kQuads + gl_LocalInvocationID.x;
  for (uint k = 0; k < kQuads; ++k, quad += local) {
    uint first = quad * 4;
    if (first >= p.words) return;
    vec4 factors = dropout4(key, first, p.threshold, p.scale);
    if (kVectors != 0) {
      add4(y4, quad, load4(x4, quad) * factors, p.accumulate)
    } else {
      for (uint j = 0; j < min(4u, p.words - first); ++j) add1(y1, first + j, load1(x1, first + j) * factors[j], p.accumulate)
    }
  }
}
