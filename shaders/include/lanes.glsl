// 1 in the lanes of vec4 number i that hold channels, 0 in padding (struct Lanes of graph/kernels/words.h).
vec4 lane_mask(uint i, uint pixels, uint blocks, uint last) {
  uint channels = (i / pixels) % blocks + 1u == blocks ? last : 4u;
  return vec4(lessThan(uvec4(0, 1, 2, 3), uvec4(channels)));
}

// The same for kernels of either width (flat_any.glsl); single words are never padding.
#ifdef WIDE
#define LANE_MASK(i, pixels, blocks, last) lane_mask(i, pixels, blocks, last)
#else
#define LANE_MASK(i, pixels, blocks, last) 1.0
#endif
