// variants: forward scores codes
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// Objects of b against those of a by s_kl = -|b_k - a_l|^2; the last of the kSlots + 1 scores is the background, code zero.
// forward: log w and q, one invocation a row k. scores: the gradient of the row's scores (B, K, K + 1), likewise.
// codes: from these the gradient of either side's codes, one invocation a number.
layout(constant_id = 1) const uint kSlots = 1;
layout(push_constant) uniform Push {
  uint count;
  uint code;
  uint identity;
#ifdef CODES
  uint of_a;
  uint accumulate;
#endif
} p;

READ1(0, a)
READ1(1, b)

#if defined(FORWARD)
WRITE1(2, log_w)
WRITE1(3, q)
#elif defined(SCORES)
READ1(2, d_log_w)
READ1(3, d_q)
WRITE1(4, d_score)
#else
READ1(2, d_score)
WRITE1(3, d_code)
#endif

#ifdef CODES
float gradient(uint entry, uint slot, uint c) {
  uint codes = entry * kSlots * p.code + c;
  uint scores = entry * kSlots * (kSlots + 1u);
  float sum = 0.0;
  if (p.of_a != 0u) {
    float own = load1(a, codes + slot * p.code);
    for (uint k = 0u; k < kSlots; ++k)
      sum += load1(d_score, scores + k * (kSlots + 1u) + slot) * 2.0 * (load1(b, codes + k * p.code) - own);
  } else {
    float own = load1(b, codes + slot * p.code);
    uint row = scores + slot * (kSlots + 1u);
    for (uint l = 0u; l < kSlots; ++l) sum -= load1(d_score, row + l) * 2.0 * (own - load1(a, codes + l * p.code));
    sum -= load1(d_score, row + kSlots) * 2.0 * own;
  }
  return sum;
}

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  uint slot = i / p.code;
  uint c = i - slot * p.code;
  uint entry = slot / kSlots;
  float value = c < p.identity ? gradient(entry, slot - entry * kSlots, c) : 0.0;
  add1(d_code, i, value, p.accumulate)
}
#else
void main() {
  uint row = flat_index();
  if (row >= p.count) return;
  uint first_a = row / kSlots * kSlots * p.code;
  float score[kSlots + 1u];
  for (uint l = 0u; l <= kSlots; ++l) {
    float distance2 = 0.0;
    for (uint c = 0u; c < p.identity; ++c) {
      float difference = load1(b, row * p.code + c) - (l < kSlots ? load1(a, first_a + l * p.code + c) : 0.0);
      distance2 += difference * difference;
    }
    score[l] = -distance2;
  }
  float largest = score[0];
  for (uint l = 1u; l < kSlots; ++l) largest = max(largest, score[l]);
  float objects = 0.0;  // of exp(score - largest)
  for (uint l = 0u; l < kSlots; ++l) objects += precise_exp(score[l] - largest);
  // q = e^largest objects / (e^largest objects + e^background), which may over- or underflow in this form.
  float log_odds = (largest - score[kSlots]) + precise_log(objects);
#ifdef FORWARD
  float log_objects = precise_log(objects);
  for (uint l = 0u; l < kSlots; ++l) log_w[row * kSlots + l] = (score[l] - largest) - log_objects;
  q[row] = precise_sigmoid(log_odds);
#else
  // By log w: d_l - w_l (sum of d). By q: dq/ds_l = w_l q (1 - q), and -q (1 - q) for the background.
  float sum = 0.0;
  for (uint l = 0u; l < kSlots; ++l) sum += load1(d_log_w, row * kSlots + l);
  float by_q = load1(d_q, row) * precise_sigmoid(log_odds) * precise_sigmoid(-log_odds);
  for (uint l = 0u; l < kSlots; ++l)
    d_score[row * (kSlots + 1u) + l] =
        load1(d_log_w, row * kSlots + l) + precise_exp(score[l] - largest) / objects * (by_q - sum);
  d_score[row * (kSlots + 1u) + kSlots] = -by_q;
#endif
}
#endif
