#include "precise.glsl"

// The same of each component, for kernels of either width (flat_any.glsl).
vec4 precise_exp(vec4 x) { return vec4(precise_exp(x.x), precise_exp(x.y), precise_exp(x.z), precise_exp(x.w)); }
vec4 precise_log(vec4 x) { return vec4(precise_log(x.x), precise_log(x.y), precise_log(x.z), precise_log(x.w)); }
vec4 precise_sigmoid(vec4 x) { return 1.0 / (1.0 + precise_exp(-x)); }
