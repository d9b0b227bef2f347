// 1 in the lanes of vec4 number i that hold channels, 0 in padding (struct Lanes of graph/kernels/words.h).
vec4 lane_mask(uint i, uint pixels, uint blocks, uint last) {
  uint channels = (i / pixels) % blocks + 1u == blocks ? last : 4u;
  return vec4(lessThan(uvec4(0, 1, 2, 3), uvec4(channels)));
}
