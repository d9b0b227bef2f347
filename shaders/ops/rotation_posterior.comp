// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// The prior depends on the turn alone, so log g = log-softmax of (correlation + prior), and
// e = sum of g (cos, sin) + (1e-8, 0), divided by its length and clamped. Backward gives the correlation's gradient.
// One invocation a slot.
layout(push_constant) uniform Push {
  uint rows;
  uint bins;
  float prior_kappa;
} p;

#ifdef FORWARD
READ1(0, correlation)
WRITE1(1, log_g)
WRITE1(2, direction)
#define LOG_G(i) log_g[i]
#else
READ1(0, log_g)
READ1(1, d_log_g)
READ1(2, d_direction)
WRITE1(3, d_correlation)
#define LOG_G(i) load1(log_g, i)
#endif

const PreciseSum kNothing = PreciseSum(0.0, 0.0);

vec2 unit(uint turn) { return cos_sin_of_step(turn, p.bins); }

vec2 mean_direction(uint begin) {
  PreciseSum x = PreciseSum(1e-8, 0.0);
  PreciseSum y = kNothing;
  for (uint t = 0u; t < p.bins; ++t) {
    float g = precise_exp(LOG_G(begin + t));
    vec2 e = unit(t);
    add_product_to(x, g, e.x);
    add_product_to(y, g, e.y);
  }
  return vec2(value_of(x), value_of(y));
}

void main() {
  uint row = flat_index();
  if (row >= p.rows) return;
  uint begin = row * p.bins;
#ifdef FORWARD
  float largest = uintBitsToFloat(0xff800000u);
  for (uint t = 0u; t < p.bins; ++t) {
    float value = load1(correlation, begin + t) + p.prior_kappa * unit(t).x;
    log_g[begin + t] = value;
    largest = max(largest, value);
  }
  PreciseSum sum = kNothing;
  for (uint t = 0u; t < p.bins; ++t) add_to(sum, precise_exp(log_g[begin + t] - largest));
  float log_sum = precise_log(value_of(sum));
  for (uint t = 0u; t < p.bins; ++t) log_g[begin + t] = (log_g[begin + t] - largest) - log_sum;
  vec2 mean = mean_direction(begin);
  vec2 e = clamp(mean / length(mean), -1.0, 1.0);
  direction[row * 2u] = e.x;
  direction[row * 2u + 1u] = e.y;
#else
  vec2 mean = mean_direction(begin);
  float size = length(mean);
  vec2 e = mean / size;
  vec2 d = vec2(load1(d_direction, row * 2u), load1(d_direction, row * 2u + 1u));
  // Rounding may leave a component of the unit vector outside [-1, 1], where the clamp has no slope.
  d = mix(d, vec2(0), greaterThan(abs(e), vec2(1)));
  vec2 d_mean = (d - e * dot(d, e)) / size;
  PreciseSum sum = kNothing;
  for (uint t = 0u; t < p.bins; ++t) {
    float value = load1(d_log_g, begin + t) + precise_exp(LOG_G(begin + t)) * dot(d_mean, unit(t));
    d_correlation[begin + t] = value;
    add_to(sum, value);
  }
  float whole = value_of(sum);
  for (uint t = 0u; t < p.bins; ++t) d_correlation[begin + t] -= precise_exp(LOG_G(begin + t)) * whole;
#endif
}
