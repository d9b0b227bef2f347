// variants: correction apply
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "flat4.glsl"
#define WIDE
#include "row_store.glsl"
#include "unit_rows.glsl"

// Adam on flat tensors, whose lengths are multiples of 4; the formula is in graph/ops/adam.h.
// With a loss scale the gradient is multiplied by its factor; where that is 0 the step is skipped.
// correction: c = (1 - beta1^t, 1 - beta2^t), one step further. apply: one invocation takes 4 consecutive vectors, or a workgroup rows (unit_rows.glsl).
layout(constant_id = 1) const uint kScaled = 0;
#ifdef CORRECTION
layout(push_constant) uniform Push {
  float beta1;
  float beta2;
  float rest1;
  float rest2;
} p;
WRITE1(0, c)
READ1(1, loss_scale)

void main() {
  if (flat_index() != 0) return;
  if (kScaled != 0 && load1(loss_scale, 3) == 0.0) return;
  c[0] = c[0] * p.beta1 + p.rest1;
  c[1] = c[1] * p.beta2 + p.rest2;
}
#else
layout(push_constant) uniform Push {
  uint vectors;
  float beta1;
  float beta2;
  float rest1;
  float rest2;
  float epsilon;
  float clip;
  ROW_DIGITS
} p;
READ4(0, gradient)
READ1(1, c)
WRITE4(2, parameters)
WRITE4(3, m)
WRITE4(4, v)
READ1(5, loss_scale)
READ4(6, old_parameters)  // and so on: the same tensors, for rows
READ4(7, old_m)
READ4(8, old_v)
READ1(9, learning_rate)

struct Moments {
  vec4 mean;
  vec4 square;
};

// g with clipped elements: comparisons that a NaN fails, so that it stays.
Moments moments(vec4 g, vec4 mean, vec4 square) {
  g = mix(g, vec4(p.clip), greaterThan(g, vec4(p.clip)));
  g = mix(g, vec4(-p.clip), lessThan(g, vec4(-p.clip)));
  return Moments(p.beta1 * mean + p.rest1 * g, p.beta2 * square + p.rest2 * g * g);
}

vec4 change(Moments now, float rate, float root) { return -rate * now.mean / (sqrt(now.square) / root + p.epsilon); }

void main() {
  float factor = kScaled != 0 ? load1(loss_scale, 3) : 1.0;
  if (kScaled != 0 && factor == 0.0) return;
  float rate = load1(learning_rate, 0) / load1(c, 0);
  float root = sqrt(load1(c, 1));
#ifdef UNIT_ROWS
  if (kUnitRows) {
    ROWS(row, i, {
      Moments now = moments(load4(gradient, i), load4(old_m, i), load4(old_v, i));
      vec4 after = load4(old_parameters, i) + change(now, rate, root);
      store4_row_below(m, int(p.vectors), row, now.mean)
      store4_row_below(v, int(p.vectors), row, now.square)
      store4_row_below(parameters, int(p.vectors), row, after)
    })
    return;
  }
#endif
  FOR4(i, flat_index() * 4, p.vectors, {
    vec4 g = load4(gradient, i);
    if (kScaled != 0) g *= factor;
    Moments now = moments(g, stored4(m, i), stored4(v, i));
    store4(m, i, now.mean)
    store4(v, i, now.square)
    store4(parameters, i, stored4(parameters, i) + change(now, rate, root))
  })
}
#endif
