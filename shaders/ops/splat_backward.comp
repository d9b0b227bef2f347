// variants: targets points
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"
#include "splat.glsl"

// With the mean m = (warped, depth) of values f = (colour, d) and its gradient g, a point's weight in a pixel has the gradient
// G = g (f - m) / divisor. `targets` leaves g / divisor, m and dtotal of each pixel, `points` gathers them: one invocation takes
// one point and its four pixels. The difference comes before the product: where few points make a pixel, f is nearly m.
#ifdef TARGETS
READ1(0, divisors)
READ1(1, warped)
READ1(2, depth)
READ1(3, dwarped)
READ1(4, ddepth)
READ1(5, dtotal)
WRITE4(6, pulls)

void main() {
  uint i = flat_index();
  uint pixels = p.width * p.height;
  uint image = i / pixels;
  if (image >= p.images) return;
  uint colour = i + image * 2 * pixels;
  vec4 g = vec4(load3(dwarped, colour, pixels), load1(ddepth, i)) / load1(divisors, i);
  vec4 mean = vec4(load3(warped, colour, pixels), load1(depth, i));
  store4(pulls, 3 * i, g)
  store4(pulls, 3 * i + 1, mean)
  store4(pulls, 3 * i + 2, vec4(load1(dtotal, i), 0, 0, 0))
}
#else
READ1(0, image)
READ1(1, uvd)
READ1(2, weight)
READ4(3, pulls)
WRITE1(4, duvd)
WRITE1(5, dweight)

void main() {
  uint i = flat_index();
  uint pixels = p.width * p.height;
  uint hypothesis = i / pixels;
  if (hypothesis >= p.images * p.slots) return;
  uint n = hypothesis / p.slots;
  vec3 point = load3(uvd, i + hypothesis * 2 * pixels, pixels);
  vec3 slope = vec3(0);
  float share_slope = 0.0;
  vec2 at;
  if (lands(point, at)) {
    float w = load1(weight, i);
    float near = nearness(point.z);
    vec4 value = vec4(load3(image, n * 3 * pixels + i - hypothesis * pixels, pixels), point.z);
    uvec2 cell = cell_of(at);
    for (uint corner = 0; corner < 4; ++corner) {
      uvec2 target = cell + uvec2(corner & 1, corner >> 1);
      if (target.x < 1 || target.y < 1 || target.x > p.width || target.y > p.height) continue;
      uint pull = 3 * (n * pixels + (target.y - 1) * p.width + target.x - 1);
      vec4 g = load4(pulls, pull);
      vec2 off = at - vec2(target);
      vec2 share = 1.0 - abs(off);
      float of_near = dot(g, value - load4(pulls, pull + 1));
      float of_a = near * of_near + load4(pulls, pull + 2).x;
      share_slope += share.x * share.y * of_a;
      slope.xy -= w * of_a * sign(off) * share.yx;
      slope.z += w * share.x * share.y * near * (g.w - p.beta * of_near);
    }
  }
  if (p.want_uvd != 0) add3(duvd, i + hypothesis * 2 * pixels, pixels, slope, p.accumulate_uvd)
  if (p.want_weight != 0) add1(dweight, i, share_slope, p.accumulate_weight)
}
#endif
