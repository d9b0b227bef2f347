// LeakyReLU of slope in (0, 1], and its derivative at x.
vec4 leaky(vec4 x, float slope) { return max(x, slope * x); }
vec4 leaky_slope(vec4 x, float slope) { return mix(vec4(slope), vec4(1), greaterThan(x, vec4(0))); }
float leaky_slope(float x, float slope) { return x > 0.0 ? 1.0 : slope; }
