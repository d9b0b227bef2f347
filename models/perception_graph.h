#pragma once

#include <vector>

#include "graph/graph.h"
#include "models/layers.h"
#include "models/model_config.h"
#include "models/object_state.h"

namespace vkopple {

/// The trained networks on single images, with running averages and no dropout, as part of a graph.
struct PerceptionGraph {
  Value images;                        ///< input "images" (B, 3, H, W) in [0, 1]
  Value depth;                         ///< (B, 1, H, W)
  ObjectState objects;                 ///< empty without objects
  std::vector<InitialTensor> tensors;  ///< parameters and running averages
};

/// Keeps what it gives under the names "depth", "masks", "location", "log_pose" (or "rotation", of Euler
/// angles) and "code". Without `objects`: depth alone.
PerceptionGraph perception_graph(Graph& graph, const ModelConfig& config, int64_t batch, bool objects,
                                 uint64_t max_tensor_bytes = ~uint64_t{0});

}  // namespace vkopple
