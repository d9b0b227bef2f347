// Winograd's minimal filtering F(m x m, 3 x 3) of stride 1, m = kMade: a tile of m x m outputs is made of kRead x kRead inputs by
//   y = A^T [ Σ ci (G w G^T) ⊙ (B^T x B) ] A
// with kRead² multiplications per pair of channels instead of 9 m². A transform takes the points 0, ±a, ±b and infinity (F2: 0, ±1 and
// infinity): A^T evaluates a polynomial's transpose there, B^T holds the coefficients of Π (x - other points), G the values of w's
// polynomial over Π (point - other points).
// F4 takes a = 3/4, b = 3/2 rather than the usual 1 and 2: all of A and B stay exact in float32, and the rounding error of the result
// is half as large (rms; a third as large at worst, measured for 64 channels).
// The functions below transform a line; the two-dimensional transforms apply them to rows, then to columns.
#ifdef F4
const int kMade = 4;
const int kRead = 6;
const float kA = 0.75, kB = 1.5;
const float kA2 = kA * kA, kB2 = kB * kB;
const float kG0 = 64.0 / 81.0, kGa = -128.0 / 243.0, kGb = 32.0 / 243.0;  // 1 / Π (point - other points)

// B^T
vec4[kRead] input_transform(vec4 d[kRead]) {
  vec4 even_a = fma(vec4(-kB2), d[2], d[4]), odd_a = kA * fma(vec4(-kB2), d[1], d[3]);
  vec4 even_b = fma(vec4(-kA2), d[2], d[4]), odd_b = kB * fma(vec4(-kA2), d[1], d[3]);
  return vec4[kRead](fma(vec4(kA2 * kB2), d[0], fma(vec4(-kA2 - kB2), d[2], d[4])), even_a + odd_a, even_a - odd_a, even_b + odd_b,
                     even_b - odd_b, fma(vec4(kA2 * kB2), d[1], fma(vec4(-kA2 - kB2), d[3], d[5])));
}

// A^T
vec4[kMade] output_transform(vec4 m[kRead]) {
  vec4 sum_a = m[1] + m[2], difference_a = m[1] - m[2];
  vec4 sum_b = m[3] + m[4], difference_b = m[3] - m[4];
  return vec4[kMade](m[0] + (sum_a + sum_b), fma(vec4(kA), difference_a, kB * difference_b), fma(vec4(kA2), sum_a, kB2 * sum_b),
                     fma(vec4(kA * kA2), difference_a, fma(vec4(kB * kB2), difference_b, m[5])));
}

// A, the transpose of output_transform
vec4[kRead] gradient_transform(vec4 d[kMade]) {
  vec4 even_a = fma(vec4(kA2), d[2], d[0]), odd_a = kA * fma(vec4(kA2), d[3], d[1]);
  vec4 even_b = fma(vec4(kB2), d[2], d[0]), odd_b = kB * fma(vec4(kB2), d[3], d[1]);
  return vec4[kRead](d[0], even_a + odd_a, even_a - odd_a, even_b + odd_b, even_b - odd_b, d[3]);
}

// G
vec4[kRead] weight_transform(vec4 w[3]) {
  vec4 even_a = fma(vec4(kA2), w[2], w[0]), odd_a = kA * w[1];
  vec4 even_b = fma(vec4(kB2), w[2], w[0]), odd_b = kB * w[1];
  return vec4[kRead](kG0 * w[0], kGa * (even_a + odd_a), kGa * (even_a - odd_a), kGb * (even_b + odd_b), kGb * (even_b - odd_b), w[2]);
}

// G^T
vec4[3] weight_gradient_transform(vec4 u[kRead]) {
  vec4 sum_a = kGa * (u[1] + u[2]), difference_a = kGa * (u[1] - u[2]);
  vec4 sum_b = kGb * (u[3] + u[4]), difference_b = kGb * (u[3] - u[4]);
  return vec4[3](fma(vec4(kG0), u[0], sum_a + sum_b), fma(vec4(kA), difference_a, kB * difference_b),
                 fma(vec4(kA2), sum_a, fma(vec4(kB2), sum_b, u[5])));
}
#else
const int kMade = 2;
const int kRead = 4;

vec4[kRead] input_transform(vec4 d[kRead]) { return vec4[kRead](d[0] - d[2], d[1] + d[2], d[2] - d[1], d[3] - d[1]); }
vec4[kMade] output_transform(vec4 m[kRead]) { return vec4[kMade](m[0] + (m[1] + m[2]), (m[1] - m[2]) + m[3]); }
vec4[kRead] gradient_transform(vec4 d[kMade]) { return vec4[kRead](d[0], d[0] + d[1], d[0] - d[1], d[1]); }
vec4[kRead] weight_transform(vec4 w[3]) {
  vec4 even = 0.5 * (w[0] + w[2]), odd = 0.5 * w[1];
  return vec4[kRead](w[0], even + odd, even - odd, w[2]);
}
vec4[3] weight_gradient_transform(vec4 u[kRead]) {
  vec4 sum = 0.5 * (u[1] + u[2]);
  return vec4[3](u[0] + sum, 0.5 * (u[1] - u[2]), sum + u[3]);
}
#endif
const int kFrequencies = kRead * kRead;
