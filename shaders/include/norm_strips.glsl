// How the reductions of normalisations share a (group, channel block)'s pixels among invocations. A group is some
// consecutive samples; its items, samples times pixels, are numbered 0 … items - 1. Strip q takes up to `each` of them,
// `1 << lanes` apart, so that neighbouring strips read neighbouring pixels.
// The push constants begin with the fields below; a kernel that has more defines them as NORM_PUSH_TAIL.
#ifndef NORM_PUSH_TAIL
#define NORM_PUSH_TAIL
#endif
layout(push_constant) uniform Push {
  uint items;   // of a group
  uint strips;  // of a (group, channel block)
  uint lanes;   // log2 of a strip's stride
  uint each;    // items of a strip, at most
  uint blocks;  // of 4 channels
  uint groups;
  uint channels;
  NORM_PUSH_TAIL
} p;

uint strip_first(uint q) { return (q >> p.lanes) * (p.each << p.lanes) + (q & ((1u << p.lanes) - 1)); }

uint strip_count(uint q) {
  uint first = strip_first(q);
  return first < p.items ? min(p.each, ((p.items - 1 - first) >> p.lanes) + 1) : 0;
}

// 1 in the lanes of block cb that are channels, 0 in padding.
vec4 real_lanes(uint cb) { return vec4(lessThan(cb * 4 + uvec4(0, 1, 2, 3), uvec4(p.channels))); }
