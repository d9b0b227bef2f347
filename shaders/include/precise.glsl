// Elementary functions in plain float32 arithmetic, within 2e-7 of the true value on every device. Of the built-in ones Vulkan
// asks much less: sin, cos and atan may be wrong by 5e-4, and exp by |x| roundings; lavapipe's exp is wrong by 3e-7 near 0 and
// by 1e-6 at 20, its log by 1.5e-7 absolute even near 1, its atan by 3e-6.
// The polynomials are minimax or Taylor ones of the usual reduced ranges.

// e^x; 0 below the smallest normal number, infinite above the largest.
float precise_exp(float x) {
  precise float n = floor(x * 1.44269504 + 0.5);
  precise float r = x - n * 0.693359375;
  r = r + n * 2.12194440e-4;
  float p = 1.9841270e-4;
  p = p * r + 1.3888889e-3;
  p = p * r + 8.3333333e-3;
  p = p * r + 4.1666667e-2;
  p = p * r + 0.16666667;
  p = p * r + 0.5;
  precise float value = (p * r * r + r) + 1.0;
  // Two factors, since 2^128 is no float.
  int power = int(clamp(n, -126.0, 128.0));
  int half_power = power >> 1;
  value = value * intBitsToFloat((half_power + 127) << 23) * intBitsToFloat((power - half_power + 127) << 23);
  if (x < -87.33654) return 0.0;
  if (x > 88.72283) return uintBitsToFloat(0x7f800000u);
  return value;
}

// ln x; minus infinity below the smallest normal number, NaN below 0.
float precise_log(float x) {
  if (x < 1.17549435e-38) return x < 0.0 ? uintBitsToFloat(0x7fc00000u) : uintBitsToFloat(0xff800000u);
  if (!(x < 3.4028235e38)) return x;
  int bits = floatBitsToInt(x);
  // x = 2^n m with m from 0.707 to 1.414.
  int n = (bits - 0x3f3504f3) >> 23;
  float m = intBitsToFloat(bits - (n << 23));
  precise float f = m - 1.0;
  // ln(1 + f) = 2 atanh(s), s = f / (2 + f), written so that f enters unrounded.
  precise float s = f / (2.0 + f);
  float z = s * s;
  float t = z * (0.66666667 + z * (0.4 + z * (0.28571429 + z * (0.22222222 + z * 0.18181818))));
  precise float h = 0.5 * f * f;
  precise float small = s * (h + t) + float(n) * -2.12194440e-4;
  precise float value = (f - (h - small)) + float(n) * 0.693359375;
  return value;
}

// (cos, sin) of an angle from -pi/4 to pi/4.
vec2 cos_sin_octant(float r) {
  float z = r * r;
  float s = ((-1.9515295891e-4 * z + 8.3321608736e-3) * z - 1.6666654611e-1) * z * r + r;
  float c = ((2.443315711809948e-5 * z - 1.388731625493765e-3) * z + 4.166664568298827e-2) * z * z;
  precise float cosine = 1.0 - (0.5 * z - c);
  return vec2(cosine, s);
}

// Turns (cos, sin) by `quarters` quarter turns.
vec2 turn_quarters(vec2 v, int quarters) {
  vec2 turned = (quarters & 1) != 0 ? vec2(-v.y, v.x) : v;
  return (quarters & 2) != 0 ? -turned : turned;
}

// (cos x, sin x); |x| up to some thousands.
vec2 precise_cos_sin(float x) {
  precise float n = floor(x * 0.636619772 + 0.5);
  precise float r = x - n * 1.5703125;
  r = r - n * 4.837512969970703125e-4;
  r = r - n * 7.54978995489188216e-8;
  return turn_quarters(cos_sin_octant(r), int(n));
}

// (cos, sin) of 2 pi step / steps, step < steps < 2^28: reduced in whole numbers.
vec2 cos_sin_of_step(uint step_, uint steps) {
  int quarters = int((8u * step_ + steps) / (2u * steps));
  int rest = 4 * int(step_) - quarters * int(steps);
  return turn_quarters(cos_sin_octant(float(rest) * 1.57079633 / float(steps)), quarters);
}

// Angle of (x, y), from -pi to pi; 0 at the origin.
float precise_atan2(float y, float x) {
  float ax = abs(x), ay = abs(y);
  float large = max(ax, ay), small = min(ax, ay);
  if (large == 0.0) return 0.0;
  // atan of a ratio in [0, 1]; above tan(pi/8) turned back by pi/4.
  bool turn = small > 0.41421356 * large;
  precise float t = turn ? (small - large) / (small + large) : small / large;
  float z = t * t;
  float p = (((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1) * z * t;
  precise float angle = p + t;
  if (turn) angle = angle + 0.785398163;
  if (ay > ax) angle = (1.57079633 - angle) + -4.37113883e-8;
  if (x < 0.0) angle = (3.14159265 - angle) + -8.74227766e-8;
  return y < 0.0 ? -angle : angle;
}

float precise_sigmoid(float x) { return 1.0 / (1.0 + precise_exp(-x)); }

float precise_tanh(float x) {
  // Near 0 the quotient loses digits; there the Taylor series is within a rounding.
  float z = x * x;
  if (z < 0.09) return x + x * z * (-0.33333333 + z * (0.13333333 + z * (-0.053968254 + z * 0.021869489)));
  float e = precise_exp(-2.0 * abs(x));
  return sign(x) * (1.0 - e) / (1.0 + e);
}

// A sum that carries what rounding lost (Neumaier).
struct PreciseSum {
  float sum;
  float lost;
};

void add_to(inout PreciseSum s, float value) {
  precise float total = s.sum + value;
  precise float part = total - s.sum;
  precise float lost = (s.sum - (total - part)) + (value - part);
  s.sum = total;
  s.lost += lost;
}

// Adds a b with the rounding of the product carried too; the product's exact error comes from halves of 12 bits, since fma need
// not be fused. |a|, |b| < 2^63.
void add_product_to(inout PreciseSum s, float a, float b) {
  precise float product = a * b;
  precise float a_shifted = a * 4097.0;
  precise float b_shifted = b * 4097.0;
  precise float a_high = a_shifted - (a_shifted - a);
  precise float b_high = b_shifted - (b_shifted - b);
  precise float a_low = a - a_high;
  precise float b_low = b - b_high;
  precise float lost = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
  add_to(s, product);
  s.lost += lost;
}

float value_of(PreciseSum s) { return s.sum + s.lost; }
