// variants: floats vectors each
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"

// dw[co][ci][tap] (+)= sum over strips, in order, of partial[strip][channel][tap][lane], each lane a vector of 4 channels.
// Channels are co and lanes ci / 4; or, where kLanesAreOut, channels are ci and lanes co / 4. Taps run backwards where kFlipped.
// An invocation takes one lane and one channel, and stores floats; or, where ci is a multiple of 4, it takes 4 channels if those are ci,
// has all taps of 4 consecutive ci, and stores vectors. Both sum all taps at once, which suits a CPU's few invocations; the variant
// `each` takes one tap, channels being co and no taps backwards, which gives a GPU as many invocations as a strip has vectors.
layout(constant_id = 1) const uint kTaps = 9;
layout(constant_id = 2) const bool kLanesAreOut = false;
layout(constant_id = 3) const bool kFlipped = false;

layout(push_constant) uniform Push {
  uint co;
  uint ci;
  uint lanes;
  uint groups;  // of channels: as many as one invocation takes
  uint strips;
  uint strip_vectors;
  uint accumulate;
} p;

READ4(0, partial)
#ifdef VECTORS
WRITE4(1, dw)
const uint kChannels = kLanesAreOut ? 4 : 1;
#else
WRITE1(1, dw)
const uint kChannels = 1;
#endif

#ifdef EACH
void main() {
  uint at = flat_index();
  if (at >= p.strip_vectors) return;
  vec4 sum = vec4(0);
  uint strip = 0;
  for (; strip + 4 <= p.strips; strip += 4) {  // four on their way at once, added in order
    vec4 v[4];
    [[unroll]] for (uint i = 0; i < 4; ++i) v[i] = load4(partial, (strip + i) * p.strip_vectors + at);
    [[unroll]] for (uint i = 0; i < 4; ++i) sum += v[i];
  }
  for (; strip < p.strips; ++strip) sum += load4(partial, strip * p.strip_vectors + at);
  uint tap = at / p.lanes % kTaps;
  uint co = at / p.lanes / kTaps;
  uint ci = at % p.lanes * 4;
  [[unroll]] for (uint i = 0; i < 4; ++i)
    if (co < p.co && ci + i < p.ci) add1(dw, (co * p.ci + ci + i) * kTaps + tap, sum[i], p.accumulate)
}
#else
uint dw_tap(uint tap) { return kFlipped ? kTaps - 1 - tap : tap; }

void main() {
  uint at = flat_index();
  if (at >= p.groups * p.lanes) return;
  uint group = at / p.lanes;
  uint lane = at % p.lanes;
  vec4 sum[kChannels * kTaps];
  [[unroll]] for (uint i = 0; i < kChannels * kTaps; ++i) sum[i] = vec4(0);
  for (uint strip = 0; strip < p.strips; ++strip) {
    uint base = strip * p.strip_vectors + group * kChannels * kTaps * p.lanes + lane;
    [[unroll]] for (uint i = 0; i < kChannels * kTaps; ++i) sum[i] += load4(partial, base + i * p.lanes);
  }
#ifdef VECTORS
  // Float number f of the 4 taps that follow one another is channel f / taps, tap f % taps.
  [[unroll]] for (uint j = 0; j < kChannels; ++j) {
    uint co = kLanesAreOut ? 4 * lane + j : group;
    uint first = co * (p.ci / 4) + (kLanesAreOut ? group : lane);
    if (co < p.co) {
      [[unroll]] for (uint v = 0; v < kTaps; ++v) {
        vec4 four;
        [[unroll]] for (uint k = 0; k < 4; ++k) {
          uint ci = (4 * v + k) / kTaps;
          uint tap = dw_tap((4 * v + k) % kTaps);
          four[k] = kLanesAreOut ? sum[ci % kChannels * kTaps + tap][j] : sum[tap][ci];
        }
        add4(dw, first * kTaps + v, four, p.accumulate)
      }
    }
  }
#else
  [[unroll]] for (uint j = 0; j < 4; ++j) {
    uint co = kLanesAreOut ? 4 * lane + j : group;
    uint ci = kLanesAreOut ? group : 4 * lane + j;
    if (co < p.co && ci < p.ci) {
      [[unroll]] for (uint tap = 0; tap < kTaps; ++tap) add1(dw, (co * p.ci + ci) * kTaps + tap, sum[dw_tap(tap)][j], p.accumulate)
    }
  }
#endif
}
#endif
