#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "linear.glsl"

// dw = dyᵀ x. An invocation makes 4 consecutive inputs of 4 consecutive outputs.
READ4(0, dy4)
READ1(1, dy1)
READ4(2, x4)
READ1(3, x1)
WRITE4(4, dw4)
WRITE1(5, dw1)

void main() {
  uint i = gl_GlobalInvocationID.x * 4, o = gl_GlobalInvocationID.y * 4;
  if (i >= p.inputs) return;
  vec4 total[4] = vec4[4](vec4(0), vec4(0), vec4(0), vec4(0));
  for (uint begin = 0; begin < p.rows; begin += kRun) {
    vec4 sum[4] = vec4[4](vec4(0), vec4(0), vec4(0), vec4(0));
    for (uint m = begin; m < min(begin + kRun, p.rows); ++m) {
      vec4 d = row4(dy, kVectorOutputs, p.y_offset + m * p.outputs, o, p.outputs);
      vec4 xs = row4(x, kVectorInputs, p.x_offset + m * p.inputs, i, p.inputs);
      for (uint j = 0; j < 4; ++j) sum[j] += d[j] * xs;
    }
    for (uint j = 0; j < 4; ++j) total[j] += sum[j];
  }
  for (uint j = 0; j < 4; ++j)
    if (o + j < p.outputs)
      add_row4(dw, kVectorInputs, (o + j) * p.inputs, i, p.inputs, total[j], p.accumulate)
}
