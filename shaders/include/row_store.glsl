// Storing a row: every lane l of a subgroup writes element base + l, all with the same base. Include after access.glsl.
//
//   layout(push_constant) uniform Push { ...; ROW_DIGITS } p;   at most 96 bytes before it
//   ALIGN_SPILLS(y)                                             first of all in main()
//   int base = known_uniform4(x)                                x < 8^4, the same in all lanes; likewise known_uniform2, 6 and 8
//   store4_row(y, inside, base, v)                              if (inside) y[base + lane] = v; outside of all control flow, `inside`
//                                                               being made of what is known to be uniform
//
// Mesa's lavapipe stores lane by lane, in a loop that spills the vector each time it takes a lane out: 16 ns on AMD Zen 5, 57 on an
// Intel with AVX-512, for 8 lanes of 16 bytes. Where it sees that an address is uniform, and no control flow masks lanes, it stores
// the first lane's value and has no loop. With kRowStores the lanes' values are therefore brought to the first by shuffles with
// constant lanes, and stored one by one: 13 ns on that Intel. It sees that an address is uniform where it is made of constants and
// push constants, and takes an element of an array of push constants for one whatever the index, which Vulkan wants to be
// dynamically uniform. So known_uniform looks up octal digits in a table that maps each to itself (Recorder::dispatch writes it).
// ALIGN_SPILLS stores nothing, but has an index of lanes that the compiler takes apart in memory. Without any such, LLVM does not align
// the stack, and vectors that it spills straddle cache lines (a fifth slower).
// What isn't inside goes beyond the end of the storage buffer, where lavapipe, which always checks bounds, stores nothing.
#ifdef TEXEL
#extension GL_EXT_shader_subgroup_extended_types_int64 : require
#include "subgroup.glsl"
layout(constant_id = 103) const bool kRowStores = false;
const int kNowhere = 0x07ffff00;
#define ALIGN_SPILLS(name) \
  { if (kRowStores) name[kNowhere + int(gl_LocalInvocationID.x)] = u64vec2(0); }
#define ROW_DIGITS layout(offset = 96) int octal[8];
#define octal_digit(x, d) (p.octal[((x) >> (3 * (d))) & 7] << (3 * (d)))
#define octal_digits2(x) (octal_digit(x, 0) | octal_digit(x, 1))
#define octal_digits4(x) (octal_digits2(x) | octal_digit(x, 2) | octal_digit(x, 3))
#define known_uniform2(x) (kRowStores ? octal_digits2(x) : (x))
#define known_uniform4(x) (kRowStores ? octal_digits4(x) : (x))
#define known_uniform6(x) (kRowStores ? octal_digits4(x) | octal_digit(x, 4) | octal_digit(x, 5) : (x))
#define known_uniform8(x) (kRowStores ? octal_digits4(x) | octal_digits4((x) >> 12) << 12 : (x))

// A lane's vector as words to store. Of 64 bits: half as many shuffles as of 32, and with them half the time to compile.
u64vec2 row_words(bool is_float16, vec4 v) {
  uvec4 words = is_float16 ? uvec4(float16_words(v), 0, 0) : floatBitsToUint(v);
  return u64vec2(packUint2x32(words.xy), packUint2x32(words.zw));
}
#define ROW_WORDS(name, v) row_words(name##_is_float16, v)
#define FROM_LANE2(words, lane) u64vec2(from_lane((words).x, lane), from_lane((words).y, lane))
// Stores the words of one lane to an address that is known to be uniform.
#define STORE_LANE(name, inside, at, words, lane)                                      \
  {                                                                                    \
    if (lane < int(kSubgroupSize)) {                                                   \
      int to_ = (inside) ? (at) : kNowhere;                                            \
      if (name##_is_float16)                                                           \
        name##_float16[to_] = from_lane((words).x, lane);                              \
      else                                                                             \
        name[to_] = FROM_LANE2(words, lane);                                           \
    }                                                                                  \
  }
// Likewise two vectors that follow one another, from an even element on.
#define STORE_LANES(name, inside, at, words_a, lane_a, words_b, lane_b)                                                \
  {                                                                                                                    \
    if (lane_a < int(kSubgroupSize)) {                                                                                 \
      if (name##_is_float16) {                                                                                         \
        STORE_LANE(name, inside, at, words_a, lane_a)                                                                  \
        STORE_LANE(name, inside, (at) + 1, words_b, lane_b)                                                            \
      } else {                                                                                                         \
        int to_ = ((inside) ? (at) : kNowhere) >> 1;                                                                   \
        name##_pairs[to_] = u64vec4(FROM_LANE2(words_a, lane_a), FROM_LANE2(words_b, lane_b));                         \
      }                                                                                                                \
    }                                                                                                                  \
  }
// y[base + lane] = v as far as that is below `limit`, which is even; kRowStores must hold.
#define store4_row_below(name, limit, base, v)                                                            \
  {                                                                                                       \
    u64vec2 words_ = ROW_WORDS(name, v);                                                                  \
    [[unroll]] for (int lane_ = 0; lane_ < kMostLanes; lane_ += 2)                                        \
      STORE_LANES(name, (base) + lane_ < (limit), (base) + lane_, words_, lane_, words_, lane_ + 1)       \
  }
#define store4_row(name, inside, base, v)                                                                 \
  {                                                                                                       \
    if (kRowStores) {                                                                                     \
      u64vec2 words_ = ROW_WORDS(name, v);                                                                \
      int row_at_ = (inside) ? (base) : kNowhere;                                                         \
      [[unroll]] for (int lane_ = 0; lane_ < kMostLanes; lane_ += 2)                                      \
        STORE_LANES(name, true, row_at_ + lane_, words_, lane_, words_, lane_ + 1)                        \
    } else if (inside) {                                                                                  \
      store4(name, (base) + int(gl_LocalInvocationID.x), v)                                               \
    }                                                                                                     \
  }
#else
const bool kRowStores = false;
#define ALIGN_SPILLS(name)
#define ROW_DIGITS
#define known_uniform2(x) (x)
#define known_uniform4(x) (x)
#define known_uniform6(x) (x)
#define known_uniform8(x) (x)
#define store4_row(name, inside, base, v) \
  { if (inside) store4(name, (base) + int(gl_LocalInvocationID.x), v) }
#endif
