// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// NC4HW4, aligned corners: y(i, j) = sum over the 4 pixels of x around (i (H - 1) / (h - 1), j (W - 1) / (w - 1)), weighted by
// their nearness. dx gathers from every pixel of dy that used it. One invocation takes one vec4 of what it writes.
layout(push_constant) uniform Push {
  uint vec4s;
  uint height;  // of x
  uint width;
  uint out_height;  // of y
  uint out_width;
  uint accumulate;
} p;

#ifdef FORWARD
READ4(0, x)
WRITE4(1, y)
#else
READ4(0, dy)
WRITE4(1, dx)
#endif

float step_of(uint size, uint out_size) { return out_size > 1 ? float(size - 1) / float(out_size - 1) : 0.0; }

// Where output i lies: the input below or at it, and how far it is beyond that.
void locate(uint i, uint size, float step, out uint low, out float beyond) {
  float at = float(i) * step;
  low = min(uint(at), size - 1);
  beyond = clamp(at - float(low), 0.0, 1.0);
}

// The share of input `at` in output i; the input after the last one is the last one.
float share(uint i, uint at, uint size, float step) {
  uint low;
  float beyond;
  locate(i, size, step, low, beyond);
  return (low == at ? 1.0 - beyond : 0.0) + (min(low + 1, size - 1) == at ? beyond : 0.0);
}

// The outputs that may use input `at`: first, and one past the last.
uvec2 users(uint at, uint out_size, float step) {
  if (step == 0.0) return uvec2(0, out_size);
  float first = floor((float(at) - 1.0) / step) - 1.0;
  float last = ceil((float(at) + 1.0) / step) + 1.0;
  return uvec2(clamp(first, 0.0, float(out_size)), clamp(last + 1.0, 0.0, float(out_size)));
}

void main() {
  uint n = flat_index();
  if (n >= p.vec4s) return;
  float step_y = step_of(p.height, p.out_height);
  float step_x = step_of(p.width, p.out_width);
#ifdef FORWARD
  uint plane = n / (p.out_height * p.out_width);
  uint top;
  uint left;
  float down;
  float right;
  locate(n / p.out_width % p.out_height, p.height, step_y, top, down);
  locate(n % p.out_width, p.width, step_x, left, right);
  uint first = plane * p.height * p.width + left;
  uint further = min(left + 1, p.width - 1) - left;
  uint upper = first + top * p.width;
  uint lower = first + min(top + 1, p.height - 1) * p.width;
  vec4 above = mix(load4(x, upper), load4(x, upper + further), right);
  vec4 below = mix(load4(x, lower), load4(x, lower + further), right);
  vec4 v = mix(above, below, down);
  store4(y, n, v)
#else
  uint plane = n / (p.height * p.width);
  uint row = n / p.width % p.height;
  uint column = n % p.width;
  uvec2 rows = users(row, p.out_height, step_y);
  uvec2 columns = users(column, p.out_width, step_x);
  vec4 sum = vec4(0);
  for (uint i = rows.x; i < rows.y; ++i) {
    float down = share(i, row, p.height, step_y);
    if (down == 0.0) continue;
    vec4 line = vec4(0);
    for (uint j = columns.x; j < columns.y; ++j)
      line += share(j, column, p.width, step_x) * load4(dy, (plane * p.out_height + i) * p.out_width + j);
    sum += down * line;
  }
  add4(dx, n, sum, p.accumulate)
#endif
}
