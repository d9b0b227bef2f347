// Procedural paint: solid patterns of three colours, functions of a point in the surface's own frame.
// Patterns 0-8 repeat and have hard edges; 16-18 are octaves of smooth noise with neither. (train/rooms/scene.h: Material)

// What a room's materials are: CPU devices pay for both where either may be.
const int kAllPeriodic = 1, kAllSmooth = 2;
layout(constant_id = 2) const int kTextures = 0;

struct Material {
  vec3 colour0, colour1, colour2, phase;
  vec4 turn;   // unit quaternion, xyz w
  float period;
  int pattern;
};

vec3 rotate(vec4 q, vec3 p) { return p + 2.0 * cross(q.xyz, cross(q.xyz, p) + q.w * p); }

// Of period 1 in [-1, 1], made of parabolas: looks like a sine and costs an eighth on CPU devices.
float wave(float x) {
  float y = 2.0 * fract(x) - 1.0;
  return 4.0 * y * (abs(y) - 1.0);
}

float odd(float x) { return 2.0 * fract(0.5 * floor(x)); }

// In [-1, 1], about as often over as under 0.
float ripple(vec3 q) {
  return wave(0.27 * q.x + 0.37 * wave(0.21 * q.y)) * wave(0.30 * q.y + 0.27 * wave(0.18 * q.z)) *
         wave(0.24 * q.z + 0.30 * wave(0.11 * q.x));
}

float bricks(vec3 q) {
  float row = floor(2.0 * q.z), along = q.x + q.y + 0.5 * row;
  bool mortar = fract(along) < 0.1 || fract(2.0 * q.z) < 0.2;
  return mortar ? 1.0 : 0.35 * odd(floor(along) + 3.0 * row);   // two shades of brick
}

float periodic(int pattern, vec3 q) {
  vec3 cell = fract(q) - 0.5;
  switch (pattern) {
    case 0: return odd(floor(q.x) + floor(q.y) + floor(q.z));                   // checks
    case 1: return odd(q.x + q.y + 0.3 * q.z);                                  // stripes
    case 2: return dot(cell, cell) < 0.27 ? 1.0 : 0.0;                          // balls: every plane cuts some
    case 3: return ripple(q) > 0.0 ? 1.0 : 0.0;                                 // blobs
    case 4: return bricks(q);
    case 5: return odd(1.5 * q.z + 2.0 * abs(fract(q.x + q.y) - 0.5));          // zigzag
    case 6: return odd(5.0 * length(fract(0.5 * q) - 0.5));                     // rings
    case 7: return odd(dot(vec3(lessThan(abs(cell), vec3(0.12))), vec3(1)));    // lattice
    default: return odd(1.3 * q.x + 0.4 * wave(0.5 * q.y) + 0.4 * wave(0.4 * q.z));   // waves
  }
}

// About 0.5 +- 0.5.
float octaves(int count, vec3 p, float period) {
  float sum = 0.0, scale = 0.24 / period, weight = 1.0;
  for (int octave = 0; octave < count; ++octave) {
    vec3 w = p * scale;
    sum += weight * wave(w.x + 0.27 * wave(w.y + 0.16 * float(octave))) * wave(1.1 * w.y + w.z + 0.2 * wave(0.9 * w.z - w.x));
    scale *= 2.0;
    weight *= 0.5;
  }
  return 0.5 + 0.6 * sum;
}

vec3 smooth_paint(Material m, vec3 p) {
  float a = octaves(4, p + m.phase, m.period);
  if (m.pattern == 17) {   // marble: veins drawn out by the noise
    a = 0.5 + 0.5 * wave(0.4 * (p.x + p.y) / m.period + 0.6 * a + m.phase.x);
  }
  vec3 base = mix(m.colour1, m.colour0, clamp(a, 0.0, 1.0));
  float cover = m.pattern == 18 ? octaves(2, p.zxy + m.phase.yzx, m.period) : 0.0;   // clouds of a third colour
  return mix(base, m.colour2, smoothstep(0.35, 0.75, cover));
}

vec3 paint(Material m, vec3 point) {
  vec3 p = rotate(m.turn, point);
  vec3 q = p / m.period + m.phase;
  vec3 base = mix(m.colour1, m.colour0, periodic(m.pattern, q));
  vec3 hard = 0.75 * base + 0.25 * (0.5 + 0.5 * ripple(q)) * m.colour2;
  if (kTextures == kAllPeriodic) return hard;
  if (kTextures == kAllSmooth) return smooth_paint(m, p);
  return m.pattern >= 16 ? smooth_paint(m, p) : hard;
}
