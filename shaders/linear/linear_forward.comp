#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "linear.glsl"

// y = x wᵀ + b. An invocation makes 4 rows of kOutputs consecutive outputs.
layout(constant_id = 3) const uint kOutputs = 4;  // at most 4
layout(constant_id = 4) const uint kBias = 1;
READ4(0, x4)
READ1(1, x1)
READ4(2, w4)
READ1(3, w1)
READ1(4, b)
WRITE1(5, y)

void main() {
  uint o = gl_GlobalInvocationID.x * kOutputs, m = gl_GlobalInvocationID.y * 4;
  if (o >= p.outputs) return;
  // Rows and outputs beyond the last are computed as the last one and not stored.
  uint x_at[4], w_at[4];
  for (uint j = 0; j < 4; ++j) {
    x_at[j] = p.x_offset + min(m + j, p.rows - 1) * p.inputs;
    w_at[j] = min(o + j, p.outputs - 1) * p.inputs;
  }
  float total[16];
  for (uint j = 0; j < 16; ++j) total[j] = 0;
  for (uint begin = 0; begin < p.inputs; begin += kRun) {
    float sum[16];
    for (uint j = 0; j < 16; ++j) sum[j] = 0;
    for (uint i = begin; i < min(begin + kRun, p.inputs); i += 4) {
      vec4 xs[4];
      for (uint r = 0; r < 4; ++r) xs[r] = row4(x, kVectorInputs, x_at[r], i, p.inputs);
      for (uint c = 0; c < kOutputs; ++c) {
        vec4 ws = row4(w, kVectorInputs, w_at[c], i, p.inputs);
        for (uint r = 0; r < 4; ++r)
          for (uint k = 0; k < 4; ++k) sum[c * 4 + r] = fma(xs[r][k], ws[k], sum[c * 4 + r]);
      }
    }
    for (uint j = 0; j < 16; ++j) total[j] += sum[j];
  }
  for (uint c = 0; c < kOutputs; ++c) {
    if (o + c >= p.outputs) break;
    float bias = kBias != 0 ? load1(b, o + c) : 0.0;
    for (uint r = 0; r < 4; ++r)
      if (m + r < p.rows) y[p.y_offset + (m + r) * p.outputs + o + c] = total[c * 4 + r] + bias;
  }
}
