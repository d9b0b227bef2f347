#include "models/object_state.h"

#include "graph/ops/align.h"
#include "graph/ops/back_project.h"
#include "graph/ops/binary.h"
#include "graph/ops/decode_location.h"
#include "graph/ops/euler_rotation.h"
#include "graph/ops/mask_centroid.h"
#include "graph/ops/match.h"
#include "graph/ops/reduce_sum.h"
#include "graph/ops/slice.h"
#include "graph/ops/slot_masks.h"
#include "graph/ops/softmax.h"
#include "models/mask_window.h"

namespace vkopple {

ObjectState object_state(const ModelConfig& config, Value raw, Value mask_logits, Value depth) {
  ObjectState state;
  state.location = decode_location(raw, static_cast<float>(config.fov), static_cast<float>(config.max_depth),
                                   static_cast<float>(config.max_height));
  const int64_t numbers = config.orientation_numbers();
  const Value orientation = slice(raw, 2, 3, numbers);
  if (config.orientation == Orientation::kYaw)
    state.log_pose = softmax(orientation, 2, true);
  else
    state.rotation = euler_rotation(orientation);
  state.code = slice(raw, 2, 3 + numbers, config.code);
  if (!mask_logits) return state;
  state.mask_logits = mask_logits;
  Value points;
  if (config.mask_window > 0 || config.mask_location)
    points = back_project(depth, static_cast<float>(config.fov));
  if (config.mask_window > 0)
    state.mask_logits = mask_window(mask_logits, points, state.location, config.mask_window);
  state.masks = slot_masks(state.mask_logits);
  if (config.mask_location) state.centroid = mask_centroid(state.masks, points);
  return state;
}

Matching match_objects(const ModelConfig& config, const ObjectState& a, const ObjectState& b) {
  const auto out = match(a.code, b.code, config.identity);
  return {.log_w = out[0], .q = out[1]};
}

ObjectState in_order_of(const Matching& matching, const ObjectState& a) {
  ObjectState ordered;
  if (a.log_pose) {
    const auto aligned = align(matching.log_w, a.place(), a.log_pose);
    ordered.location = aligned[0];
    ordered.log_pose = aligned[1];
    return ordered;
  }
  // Σ_l w_kl x_l.
  Graph& graph = a.location.graph();
  const Shape k_l = matching.log_w.shape();
  const Value w = graph.reshape(softmax(matching.log_w, 2, false), row_major({k_l[0], k_l[1], k_l[2], 1}));
  const auto mean = [&](Value x) {
    const Shape s = x.shape();
    const Value parts = mul(w, graph.reshape(x, row_major({s[0], 1, s[1], s.product(2, s.rank())})));
    return graph.reshape(reduce_sum(parts, {2}), row_major(s));
  };
  ordered.location = mean(a.place());
  ordered.rotation = mean(a.rotation);
  return ordered;
}

}  // namespace vkopple
