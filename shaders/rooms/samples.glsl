// The kSamples x kSamples rays of a pixel. Needs scene.glsl and kSamples before it.

// Where sample s of a pixel is; as unsigned numbers, whose division is cheaper.
int column_of(int s) { return int(uint(s) % uint(kSamples)); }
int line_of(int s) { return int(uint(s) / uint(kSamples)); }

// A vector that is linear in the place in the image: at the first sample of a pixel, and what it grows by to the sample to the
// right and the one below.
struct Linear {
  vec3 start, right, down;
};

Linear direction(View v, vec2 centre) {
  float step = 1.0 / float(kSamples);
  return Linear(towards(v, centre - (0.5 - 0.5 * step)), v.right * (step / focal), v.up * (-step / focal));
}

Linear transform(mat3 m, Linear x) { return Linear(m * x.start, m * x.right, m * x.down); }
Linear scale(Linear x, vec3 by) { return Linear(x.start * by, x.right * by, x.down * by); }
vec3 at(Linear x, int i, int j) { return x.start + float(j) * x.down + float(i) * x.right; }
