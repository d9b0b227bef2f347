#include "models/mask_window.h"

#include "graph/ops/affine.h"
#include "graph/ops/permute.h"
#include "graph/ops/reduce_sum.h"
#include "models/squared_difference.h"

namespace vkopple {

Value mask_window(Value logits, Value points, Value location, double radius) {
  Graph& graph = logits.graph();
  const Scope scope(graph, "mask_window");
  const Shape s = logits.shape();
  const int64_t pixels = s[2] * s[3];
  const Value p = graph.reshape(points, row_major({1, s[1], 3, pixels}));
  const Value x = graph.reshape(permute(location, {1, 0, 2}), row_major({s[0], s[1], 3, 1}));
  const Value squares = reduce_sum(squared_difference(p, x), {2});
  const Value fall =
      affine(graph.reshape(squares, row_major(s)), static_cast<float>(-0.5 / (radius * radius)), 0);
  return add(logits, fall);
}

}  // namespace vkopple
