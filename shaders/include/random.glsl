// Random numbers without a state to carry: a hash of (seed, step, stream, index), so that backward finds the mask of forward again.
// Two chains of MurmurHash3's finaliser make a 64-bit key of the first three; each index is then hashed with both halves.
// graph/checks/check_random.h computes the same integers on the host.
uint mix_bits(uint v) {
  v ^= v >> 16;
  v *= 0x85ebca6bu;
  v ^= v >> 13;
  v *= 0xc2b2ae35u;
  return v ^ (v >> 16);
}

uvec2 random_key(uint seed, uint step_number, uint stream) {
  return uvec2(mix_bits(mix_bits(mix_bits(seed + 0x9e3779b9u) + step_number) + stream),
               mix_bits(mix_bits(mix_bits(stream + 0x7f4a7c15u) + seed) + step_number));
}

uvec4 random_bits4(uvec2 key, uvec4 index) {
  uvec4 v = index + key.x;
  v ^= v >> 16;
  v *= 0x85ebca6bu;
  v ^= v >> 13;
  v ^= key.y;
  v *= 0xc2b2ae35u;
  return v ^ (v >> 16);
}

// Factors of dropout for words first … first + 3 of a tensor: 0 where the random word is below `threshold`, else `scale`.
vec4 dropout4(uvec2 key, uint first, uint threshold, float scale) {
  return mix(vec4(scale), vec4(0), lessThan(random_bits4(key, first + uvec4(0, 1, 2, 3)), uvec4(threshold)));
}
