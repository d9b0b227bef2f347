// Vectors of 3 whose components lie a plane of `pixels` floats apart: points and colours of (…, 3, H, W). `at` is the first one's
// place. Include access.glsl before.
#define load3(name, at, pixels) vec3(load1(name, at), load1(name, (at) + (pixels)), load1(name, (at) + 2 * (pixels)))
#define store3(name, at, pixels, v) \
  { vec3 three_ = v; name[at] = three_.x; name[(at) + (pixels)] = three_.y; name[(at) + 2 * (pixels)] = three_.z; }
#define add3(name, at, pixels, v, accumulate) \
  { \
    vec3 sum_ = v; \
    if ((accumulate) != 0u) sum_ += vec3(name[at], name[(at) + (pixels)], name[(at) + 2 * (pixels)]); \
    store3(name, at, pixels, sum_) \
  }
