// variants: correction apply
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"

// Adam on flat tensors, whose lengths are multiples of 4; the formula is in graph/ops/adam.h.
// With a loss scale the gradient is multiplied by its factor; where that is 0 the step is skipped.
// correction: c = (1 - beta1^t, 1 - beta2^t), one step further. apply: one invocation takes 4 consecutive vectors.
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
  float learning_rate;
  float beta1;
  float beta2;
  float rest1;
  float rest2;
  float epsilon;
  float clip;
} p;
READ4(0, gradient)
READ1(1, c)
WRITE4(2, parameters)
WRITE4(3, m)
WRITE4(4, v)
READ1(5, loss_scale)

void main() {
  float factor = kScaled != 0 ? load1(loss_scale, 3) : 1.0;
  if (kScaled != 0 && factor == 0.0) return;
  float rate = p.learning_rate / load1(c, 0);
  float root = sqrt(load1(c, 1));
  FOR4(i, flat_index() * 4, p.vectors, {
    vec4 g = load4(gradient, i);
    if (kScaled != 0) g *= factor;
    // Comparisons that a NaN fails: it stays.
    g = mix(g, vec4(p.clip), greaterThan(g, vec4(p.clip)));
    g = mix(g, vec4(-p.clip), lessThan(g, vec4(-p.clip)));
    vec4 mean = p.beta1 * stored4(m, i) + p.rest1 * g;
    vec4 square = p.beta2 * stored4(v, i) + p.rest2 * g * g;
    store4(m, i, mean)
    store4(v, i, square)
    store4(parameters, i, stored4(parameters, i) - rate * mean / (sqrt(square) / root + p.epsilon))
  })
}
#endif
