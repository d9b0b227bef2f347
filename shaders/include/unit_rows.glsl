// Kernels that make the vec4s of a tensor, each from those of the same number in others: an invocation takes 4 that follow one another,
// or, with kUnitRows, a workgroup of one subgroup kRowsOfGroup rows of them, in straight code (row_store.glsl). Recorder::dispatch_units
// chooses. Include after flat_any.glsl and row_store.glsl; the variant of single words has no rows.
//
//   ROWS(row, i, body)   within #ifdef UNIT_ROWS and where kUnitRows: body for each of the workgroup's rows, which starts at unit `row`,
//                        known to be uniform; `i` is this lane's unit of it, or beyond the last one
#if defined(TEXEL) && defined(WIDE)
#define UNIT_ROWS
layout(constant_id = 4) const int kRowsOfGroup = 0;
const bool kUnitRows = kRowsOfGroup > 0;

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
