// Kernels whose invocations make 4 consecutive vec4s of one tensor, or, where the runtime says so (kUnitRows, set by
// Recorder::dispatch_units), a subgroup's rows of it, in straight code (row_store.glsl). Include after flat_any.glsl.
//
//   FOR_UNITS(i, units, body)     in main(): body for every unit of the invocation; with rows, body is never reached: call
//   ROWS(first, at, body)         body for `at`, the unit of this lane in each of the workgroup's rows, the row starting at `first`,
//                                 which is known to be uniform; only within #ifdef UNIT_ROWS
#if defined(TEXEL) && defined(WIDE)
#define UNIT_ROWS
layout(constant_id = 4) const bool kUnitRows = false;
const int kRowsOfGroup = 8;  // twice as many gain a tenth

// The first unit of the workgroup.
#define FIRST_UNIT                                                                                                                     \
  ((known_uniform6(int(gl_WorkGroupID.x)) +                                                                                            \
    known_uniform6(int(gl_WorkGroupID.y)) * known_uniform6(int(gl_NumWorkGroups.x))) *                                                 \
   kRowsOfGroup * int(gl_WorkGroupSize.x))
#define ROWS(row, at, body)                                        \
  {                                                                \
    int first_ = FIRST_UNIT;                                     \
    [[unroll]] for (int k_ = 0; k_ < kRowsOfGroup; ++k_) {         \
      int row = first_ + k_ * int(gl_WorkGroupSize.x);             \
      uint at = uint(row) + gl_LocalInvocationID.x;                \
      body                                                         \
    }                                                              \
  }
#endif
