// Procedural paint: solid patterns of three colours, functions of a point in the surface's own frame.
// Patterns 0-8 repeat and have hard edges; 16-18 are octaves of smooth noise with neither. (train/rooms/scene.h: Material)

// What a room's materials are: CPU devices pay for both where either may be.
const int kAllPeriodic = 1, kAllSmooth = 2;
layout(constant_id = 2) const int kTextures = 0;
const int kFirstSmooth = 16;

// A point p is painted by what the pattern is at q = turn p + phase.
struct Material {
  mat3 turn;       // over the period
  vec3 phase;
  mat3 colours;    // a column each
  int pattern;
  float shift;     // of marble's veins
};

// Of period 1 in [-1, 1], made of parabolas: looks like a sine and costs an eighth on CPU devices.
float wave(float x) {
  float y = fract(x) - 0.5;
  return 16.0 * y * (abs(y) - 0.5);
}

float odd(float x) { return 2.0 * fract(0.5 * floor(x)); }

// In [-1, 1], about as often over as under 0.
float ripple(vec3 q) {
  return wave(0.27 * q.x + 0.37 * wave(0.21 * q.y)) * wave(0.30 * q.y + 0.27 * wave(0.18 * q.z)) *
         wave(0.24 * q.z + 0.30 * wave(0.11 * q.x));
}

// In [0, 1], most of them 0 and 1.
float periodic(int pattern, vec3 q) {
  vec3 cell = fract(q) - 0.5;
  float x, least = 1.0;
  switch (pattern) {
    case 0: x = floor(q.x) + floor(q.y) + floor(q.z); break;                       // checks
    case 1: x = q.x + q.y + 0.3 * q.z; break;                                      // stripes
    case 2: x = dot(cell, cell) < 0.27 ? 1.0 : 0.0; break;                         // balls: every plane cuts some
    case 3: x = ripple(q) > 0.0 ? 1.0 : 0.0; break;                                // blobs
    case 4: {                                                                      // bricks of two shades
      float row = floor(2.0 * q.z), along = q.x + q.y + 0.5 * row;
      bool mortar = fract(along) < 0.1 || fract(2.0 * q.z) < 0.2;
      x = mortar ? 1.0 : floor(along) + 3.0 * row;
      least = mortar ? 1.0 : 0.35;
      break;
    }
    case 5: x = 1.5 * q.z + 2.0 * abs(fract(q.x + q.y) - 0.5); break;              // zigzag
    case 6: x = 5.0 * length(fract(0.5 * q) - 0.5); break;                         // rings
    case 7: x = dot(vec3(lessThan(abs(cell), vec3(0.12))), vec3(1)); break;        // lattice
    default: x = 1.3 * q.x + 0.4 * wave(0.5 * q.y) + 0.4 * wave(0.4 * q.z); break; // waves
  }
  return least * odd(x);
}

// About 0.5 +- 0.5.
float octaves(int count, vec3 q) {
  float sum = 0.0, scale = 0.24, weight = 1.0;
  for (int octave = 0; octave < count; ++octave) {
    vec3 w = q * scale;
    sum += weight * wave(w.x + 0.27 * wave(w.y + 0.16 * float(octave))) * wave(1.1 * w.y + w.z + 0.2 * wave(0.9 * w.z - w.x));
    scale *= 2.0;
    weight *= 0.5;
  }
  return 0.5 + 0.6 * sum;
}

vec3 smooth_shares(Material m, int pattern, vec3 q) {
  float a = octaves(4, q);
  if (pattern == 17) a = 0.5 + 0.5 * wave(0.4 * (q.x + q.y) + 0.6 * a + m.shift);   // marble: veins drawn out by the noise
  a = clamp(a, 0.0, 1.0);
  float cover = pattern == 18 ? smoothstep(0.35, 0.75, octaves(2, (q - m.phase).zxy + m.phase.yzx)) : 0.0;   // clouds
  return vec3((1.0 - cover) * a, (1.0 - cover) * (1.0 - a), cover);
}

vec3 periodic_shares(int pattern, vec3 q) {
  float a = periodic(pattern, q);
  return vec3(0.75 * a, 0.75 * (1.0 - a), 0.25 * (0.5 + 0.5 * ripple(q)));
}

// How much of each of its colours the material shows at q; no more than 1 in all. `pattern` is the material's: where it is a
// constant, no other is computed.
vec3 shares(Material m, int pattern, vec3 q) {
  if (kTextures == kAllPeriodic) return periodic_shares(pattern, q);
  if (kTextures == kAllSmooth) return smooth_shares(m, pattern, q);
  return pattern >= kFirstSmooth ? smooth_shares(m, pattern, q) : periodic_shares(pattern, q);
}
