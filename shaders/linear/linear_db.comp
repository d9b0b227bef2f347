#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "linear.glsl"

// db = the sum of dy over its rows. An invocation makes one output.
READ1(0, dy)
WRITE1(1, db)

void main() {
  uint o = gl_GlobalInvocationID.x;
  if (o >= p.outputs) return;
  float total = 0;
  for (uint begin = 0; begin < p.rows; begin += kRun) {
    float sum = 0;
    for (uint m = begin; m < min(begin + kRun, p.rows); ++m) sum += load1(dy, p.y_offset + m * p.outputs + o);
    total += sum;
  }
  add1(db, o, total, p.accumulate)
}
