// The normal distribution, within some 1e-7 of the true values on every device. Include precise.glsl before.
// Polynomials fitted at Chebyshev points: erf(z) / z in z^2 for z below 1, exp(z^2) erfc(z) in 2 / (2 + z) from there to 4.3.

// The share of the distribution below x.
float normal_below(float x) {
  float z = abs(x) * 0.707106781;
  if (z < 1.0) {
    float t = z * z;
    float p = 7.88249712e-5;
    p = p * t - 8.01885499e-4;
    p = p * t + 5.18931194e-3;
    p = p * t - 2.68543288e-2;
    p = p * t + 0.112835975;
    p = p * t - 0.376126269;
    p = p * t + 1.12837917;
    float half_erf = 0.5 * z * p;
    return x < 0.0 ? 0.5 - half_erf : 0.5 + half_erf;
  }
  float s = 2.0 / (2.0 + min(z, 4.3));
  float p = 0.118713025;
  p = p * s - 0.468948891;
  p = p * s + 0.559867034;
  p = p * s - 0.100767876;
  p = p * s + 0.346382549;
  p = p * s + 0.260111237;
  p = p * s + 0.28484272;
  p = p * s - 1.49283526e-4;
  float half_erfc = 0.5 * p * precise_exp(-z * z);
  return x < 0.0 ? half_erfc : 1.0 - half_erfc;
}

// Its density at x.
float normal_density(float x) { return 0.398942280 * precise_exp(-0.5 * x * x); }

vec4 normal_below(vec4 x) { return vec4(normal_below(x.x), normal_below(x.y), normal_below(x.z), normal_below(x.w)); }
vec4 normal_density(vec4 x) { return 0.398942280 * precise_exp(-0.5 * x * x); }
