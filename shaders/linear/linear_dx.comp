#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "linear.glsl"

// dx = dy w. An invocation makes 4 rows of 4 consecutive inputs.
READ4(0, dy4)
READ1(1, dy1)
READ4(2, w4)
READ1(3, w1)
WRITE4(4, dx4)
WRITE1(5, dx1)

void main() {
  uint i = gl_GlobalInvocationID.x * 4, m = gl_GlobalInvocationID.y * 4;
  if (i >= p.inputs) return;
  uint dy_at[4];
  for (uint r = 0; r < 4; ++r) dy_at[r] = p.y_offset + min(m + r, p.rows - 1) * p.outputs;
  vec4 total[4] = vec4[4](vec4(0), vec4(0), vec4(0), vec4(0));
  for (uint begin = 0; begin < p.outputs; begin += kRun) {
    vec4 sum[4] = vec4[4](vec4(0), vec4(0), vec4(0), vec4(0));
    for (uint o = begin; o < min(begin + kRun, p.outputs); o += 4) {
      vec4 d[4];
      for (uint r = 0; r < 4; ++r) d[r] = row4(dy, kVectorOutputs, dy_at[r], o, p.outputs);
      for (uint j = 0; j < 4; ++j) {
        // Beyond the last output d is zero; the last row of w stands in.
        uint w_at = min(o + j, p.outputs - 1) * p.inputs;
        vec4 ws = row4(w, kVectorInputs, w_at, i, p.inputs);
        for (uint r = 0; r < 4; ++r) sum[r] += d[r][j] * ws;
      }
    }
    for (uint r = 0; r < 4; ++r) total[r] += sum[r];
  }
  for (uint r = 0; r < 4; ++r)
    if (m + r < p.rows)
      add_row4(dx, kVectorInputs, p.x_offset + (m + r) * p.inputs, i, p.inputs, total[r], p.accumulate)
}
