// How far distributions a and r are from each other, bin by bin, from logarithms u of a and v of r. Include precise.glsl before.
// With d = u - v:
//   symmetric KL: D = 1/2 sum (a - r) d;  dD/du = 1/2 (a d + a - r),  dD/dv = -1/2 (r d + a - r)
//   Jensen-Shannon, m = (a + r) / 2: D = 1/2 sum a log(a / m) + r log(r / m);  dD/du = 1/2 a log(a / m), the same for r,
//     because a log m + r log m = 2 m log m changes with a by log m + 1, and the 1 cancels that of a log a.
layout(constant_id = 1) const uint kDivergence = 0;  // enum PoseDivergence

// log(a / m) from d = log a - log r: -log((1 + exp(-d)) / 2), written so that exp does not overflow.
float log_over_mean(float d) { return 0.69314718 - max(-d, 0.0) - precise_log(1.0 + precise_exp(-abs(d))); }

float bin_divergence(float u, float v) {
  float d = u - v;
  if (kDivergence == 0) return 0.5 * (precise_exp(u) - precise_exp(v)) * d;
  return 0.5 * (precise_exp(u) * log_over_mean(d) + precise_exp(v) * log_over_mean(-d));
}

// dD/du; dD/dv is the same with u and v exchanged.
float divergence_slope(float u, float v) {
  float a = precise_exp(u);
  return 0.5 * (kDivergence == 0 ? a * (u - v) + (a - precise_exp(v)) : a * log_over_mean(u - v));
}

// Adds `term`, an expression in n, over bins n, in runs of 32.
#define BIN_SUM(total, bins, term)                                        \
  for (uint first_ = 0; first_ < (bins); first_ += 32) {                  \
    float part_ = 0.0;                                                    \
    for (uint n = first_; n < min(first_ + 32, (bins)); ++n) part_ += term; \
    total += part_;                                                       \
  }
