// How kernels reach their operands. Declare every binding with one of these macros, numbered from 0 without gaps, reads and writes
// in any order:
//
//   READ4(0, x)    vec4 elements    load4(x, i)
//   READ1(1, w)    float elements   load1(w, i)
//   READU(2, n)    uint elements    n[i]
//   WRITE4(3, y)   vec4 elements    store4(y, i, v)   stored4(y, i)   add4(y, i, v, accumulate)
//   WRITE1(4, y)   float elements   y[i] = v                          add1(y, i, v, accumulate)
//   WRITEU(5, n)   uint elements    n[i] = v
//
// With TEXEL, reads are texel fetches and vec4 stores two 64-bit ones (each measured far faster on lavapipe); without,
// everything is a storage buffer. load4_or_zero(x, inside, i) gives zeros where `inside` is false.
// One operand must not be bound for reading and for writing in one dispatch; use stored4 on the written binding instead. Kernels that
// store rows (row_store.glsl) are the exception: they add to what a READ4 of the same tensor holds, each lane reading its elements
// before anything writes them.
// The suffixes that the macros give to names (_r4, _r1, _ru, _w4, _w) tell the runtime what each binding is.
//
// What READ4 and WRITE4 declare may hold float16 (8 bytes an element) as well as float32: load4, store4, stored4 and add4 give and
// take float32 all the same. Bit b of kFloat16Bindings, which the runtime sets from the operands, says so of binding b; of a
// texel buffer its format does. The kernel need not know.
#include "float16.glsl"
layout(constant_id = 102) const uint kFloat16Bindings = 0u;
#define FLOAT16_FLAG(number, name) const bool name##_is_float16 = (kFloat16Bindings & (1u << number)) != 0u;
#ifdef TEXEL
#extension GL_ARB_gpu_shader_int64 : require
#define READ4(number, name) layout(binding = number) uniform samplerBuffer name##_r4;
#define READ1(number, name) layout(binding = number) uniform samplerBuffer name##_r1;
#define load4(name, i) texelFetch(name##_r4, int(i))
#define load1(name, i) texelFetch(name##_r1, int(i)).x
#define WRITE4(number, name) \
  FLOAT16_FLAG(number, name) \
  layout(std430, binding = number) buffer name##_w4 { u64vec2 name[]; }; \
  layout(std430, binding = number) buffer name##_float16_w4 { uint64_t name##_float16[]; }; \
  layout(std430, binding = number) buffer name##_pairs_w4 { u64vec4 name##_pairs[]; };
#define store4(name, i, v) \
  { \
    vec4 stored_ = v; \
    if (name##_is_float16) { \
      name##_float16[i] = packUint2x32(float16_words(stored_)); \
    } else { \
      uvec4 bits_ = floatBitsToUint(stored_); \
      name[i] = u64vec2(packUint2x32(bits_.xy), packUint2x32(bits_.zw)); \
    } \
  }
#define stored4(name, i) \
  (name##_is_float16 ? float16_values(unpackUint2x32(name##_float16[i])) \
                     : uintBitsToFloat(uvec4(unpackUint2x32(name[i].x), unpackUint2x32(name[i].y))))
#else
#define READ4(number, name) \
  FLOAT16_FLAG(number, name) \
  layout(std430, binding = number) readonly buffer name##_r4 { vec4 name[]; }; \
  layout(std430, binding = number) readonly buffer name##_float16_r4 { uvec2 name##_float16[]; };
#define READ1(number, name) layout(std430, binding = number) readonly buffer name##_r1 { float name[]; };
#define load4(name, i) (name##_is_float16 ? float16_values(name##_float16[i]) : name[i])
#define load1(name, i) name[i]
#define WRITE4(number, name) \
  FLOAT16_FLAG(number, name) \
  layout(std430, binding = number) buffer name##_w4 { vec4 name[]; }; \
  layout(std430, binding = number) buffer name##_float16_w4 { uvec2 name##_float16[]; };
#define store4(name, i, v) \
  { \
    vec4 stored_ = v; \
    if (name##_is_float16) { \
      name##_float16[i] = float16_words(stored_); \
    } else { \
      name[i] = stored_; \
    } \
  }
#define stored4(name, i) load4(name, i)
#endif
#define READU(number, name) layout(std430, binding = number) readonly buffer name##_ru { uint name[]; };
#define WRITE1(number, name) layout(std430, binding = number) buffer name##_w { float name[]; };
#define WRITEU(number, name) layout(std430, binding = number) buffer name##_w { uint name[]; };

// True where a texel fetch outside its view gives zeros at no cost.
layout(constant_id = 100) const bool kZeroOutside = false;
#ifdef TEXEL
#define load4_or_zero(name, inside, i) (kZeroOutside ? load4(name, (inside) ? int(i) : -1) : ((inside) ? load4(name, i) : vec4(0)))
#define load1_or_zero(name, inside, i) (kZeroOutside ? load1(name, (inside) ? int(i) : -1) : ((inside) ? load1(name, i) : 0.0))
#else
#define load4_or_zero(name, inside, i) ((inside) ? load4(name, i) : vec4(0))
#define load1_or_zero(name, inside, i) ((inside) ? name[i] : 0.0)
#endif

// The same as words of float16 (float16.glsl), for kernels that compute with them: as they lie where the operand holds float16, else
// rounded.
#ifdef TEXEL
#define words4(name, i) float16_words(load4(name, i))
#else
#define words4(name, i) (name##_is_float16 ? name##_float16[i] : float16_words(name[i]))
#endif
#define words4_or_zero(name, inside, i) ((inside) ? words4(name, i) : uvec2(0))

// Gradients: `accumulate` 0 overwrites without reading what is there, 1 adds to it.
#define add4(name, i, v, accumulate) \
  { vec4 new_ = v; if ((accumulate) != 0u) new_ += stored4(name, i); store4(name, i, new_) }
#define add1(name, i, v, accumulate) \
  { float new_ = v; if ((accumulate) != 0u) new_ += name[i]; name[i] = new_; }

layout(local_size_x_id = 0) in;

// The invocation's number in a dispatch_flat.
uint flat_index() {
  return gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * gl_WorkGroupSize.x);
}
