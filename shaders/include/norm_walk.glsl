// The push constants of the two strip reductions, and the walk over a strip's items in storage.
#define NORM_PUSH_TAIL \
  uint pixels;      /* of a sample */ \
  uint per_group;   \
  uint step_pixel;  /* (1 << lanes) modulo pixels */ \
  uint step_at;     /* vectors from an item to the next of its strip, where that lies in no later row of samples */ \
  uint wrap;        /* further vectors where step_pixel runs past the sample's end */ \
  float slope;      /* of the LeakyReLU before */ \
  uint stream;      /* of dropout */ \
  uint threshold; \
  float scale;

#include "norm_strips.glsl"

struct Walk {
  uint at;  // index of the vector
  uint pixel;
};

Walk walk_begin(uint group, uint cb, uint q) {
  uint first = strip_first(q);
  uint sample_number = first / p.pixels;
  uint pixel = first - sample_number * p.pixels;
  return Walk(((group * p.per_group + sample_number) * p.blocks + cb) * p.pixels + pixel, pixel);
}

void walk_on(inout Walk walk) {
  walk.at += p.step_at;
  walk.pixel += p.step_pixel;
  if (walk.pixel >= p.pixels) {
    walk.pixel -= p.pixels;
    walk.at += p.wrap;
  }
}
