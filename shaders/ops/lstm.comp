// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// The elementwise part of one step of an LSTM; one invocation takes unit j of sample b. Gates in the order i f g o:
//   a = input_part + hidden_part + b_ih + b_hh;  i, f, o = sigmoid(a), g = tanh(a)
//   c = f c_before + i g;  h = o tanh(c)
// gates [step][b][4 H] after their activations, cells and hidden [step][b][H], y and dy [b][step][H].
// Backward goes from the last step to the first. dh_next is what the step after sends back through w_hh, dc the gradient of the
// cell on its way back, da the gradient of a, da_sum its sum over the steps done.
layout(push_constant) uniform Push {
  uint batch;
  uint size;
  uint steps;
  uint step_;
} p;

#ifdef FORWARD
READ1(0, input_part)
READ1(1, hidden_part)
READ1(2, b_ih)
READ1(3, b_hh)
WRITE1(4, gates)
WRITE1(5, cells)
WRITE1(6, hidden)
WRITE1(7, y)
#else
READ1(0, dy)
READ1(1, dh_next)
READ1(2, gates)
READ1(3, cells)
WRITE1(4, da)
WRITE1(5, da_sum)
WRITE1(6, dc)
#endif

void main() {
  uint unit = flat_index();
  if (unit >= p.batch * p.size) return;
  uint b = unit / p.size, j = unit - b * p.size;
  uint layer = p.batch * p.size;                          // a step's cells
  uint cell_at = p.step_ * layer + unit;
  uint own = b * 4 * p.size + j;                          // of gate i in (batch, 4 H)
  uint gates_at = p.step_ * 4 * layer + own;
  uint y_at = (b * p.steps + p.step_) * p.size + j;
#ifdef FORWARD
  vec4 a;
  for (uint k = 0; k < 4; ++k) {
    uint row = k * p.size;
    a[k] = load1(input_part, own + row) + load1(b_ih, row + j) + load1(b_hh, row + j);
    if (p.step_ > 0) a[k] += load1(hidden_part, own + row);
  }
  float i = precise_sigmoid(a.x), f = precise_sigmoid(a.y), g = precise_tanh(a.z), o = precise_sigmoid(a.w);
  float c = i * g;
  if (p.step_ > 0) c += f * cells[cell_at - layer];
  float h = o * precise_tanh(c);
  gates[gates_at] = i;
  gates[gates_at + p.size] = f;
  gates[gates_at + 2 * p.size] = g;
  gates[gates_at + 3 * p.size] = o;
  cells[cell_at] = c;
  hidden[cell_at] = h;
  y[y_at] = h;
#else
  bool last = p.step_ + 1 == p.steps;
  float i = load1(gates, gates_at), f = load1(gates, gates_at + p.size);
  float g = load1(gates, gates_at + 2 * p.size), o = load1(gates, gates_at + 3 * p.size);
  float before = p.step_ > 0 ? load1(cells, cell_at - layer) : 0.0;
  float tanh_c = precise_tanh(load1(cells, cell_at));
  float dh = load1(dy, y_at);
  if (!last) dh += load1(dh_next, unit);
  float dcell = dh * o * (1.0 - tanh_c * tanh_c);
  if (!last) dcell += dc[unit];
  dc[unit] = dcell * f;
  vec4 d = vec4(dcell * g * i * (1.0 - i), dcell * before * f * (1.0 - f), dcell * i * (1.0 - g * g),
                dh * tanh_c * o * (1.0 - o));
  for (uint k = 0; k < 4; ++k) {
    da[gates_at + k * p.size] = d[k];
    add1(da_sum, own + k * p.size, d[k], last ? 0u : 1u)
  }
#endif
}
