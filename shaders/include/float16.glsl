// Four numbers as float16 in 8 bytes, the first in the low bits. Rounded to nearest even by integer arithmetic, because
// packHalf2x16 rounds as each driver likes (Mesa's CPU driver cuts off, which biases sums): the bits are the same on every
// device. 65520 and more become infinity, which loss scaling looks for.
uvec2 float16_words(vec4 v) {
  uvec4 bits = floatBitsToUint(v);
  uvec4 size = bits & 0x7fffffffu;
  // The exponent's bias goes from 127 to 15, and 13 bits are dropped; a carry of the rounding may raise the exponent.
  uvec4 normal = (size - 0x38000000u + 0xfffu + ((size >> 13) & 1u)) >> 13;
  // Below 2^-14 float16 counts in steps of 2^-24, as float32 does from 0.5 to 1.
  precise vec4 shifted = uintBitsToFloat(size) + 0.5;
  uvec4 subnormal = floatBitsToUint(shifted) - 0x3f000000u;
  uvec4 special = mix(uvec4(0x7c00u), uvec4(0x7e00u), greaterThan(size, uvec4(0x7f800000u)));
  uvec4 word = mix(normal, subnormal, lessThan(size, uvec4(0x38800000u)));
  word = mix(word, special, greaterThanEqual(size, uvec4(0x47800000u)));
  word |= (bits >> 16) & 0x8000u;
  return word.xz | (word.yw << 16);
}

vec4 float16_values(uvec2 words) { return vec4(unpackHalf2x16(words.x), unpackHalf2x16(words.y)); }
