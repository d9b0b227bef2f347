#include "models/perception_graph.h"

#include "graph/ops/relayout.h"
#include "models/depth_net.h"
#include "models/network_options.h"
#include "models/object_net.h"

namespace vkopple {

PerceptionGraph perception_graph(Graph& graph, const ModelConfig& config, int64_t batch, bool objects,
                                 uint64_t max_tensor_bytes) {
  PerceptionGraph made;
  const auto use = [&](const LayerFactory& layers) {
    made.tensors.insert(made.tensors.end(), layers.tensors().begin(), layers.tensors().end());
  };
  made.images = graph.input("images", row_major({batch, 3, config.height, config.width}));
  const Value images4 = to_channels4(made.images);
  LayerFactory depth(graph, network_options(config, "depth", false, {}, max_tensor_bytes));
  made.depth = depth_net(depth, config, images4);
  use(depth);
  graph.keep("depth", made.depth);
  if (!objects) return made;
  LayerFactory layers(graph, network_options(config, "object", false, {}, max_tensor_bytes));
  const ObjectOutputs out = object_net(layers, config, images4, {true}).front();
  use(layers);
  made.objects = object_state(config, out.raw, out.mask_logits, made.depth);
  graph.keep("masks", made.objects.masks);
  graph.keep("location", made.objects.place());
  if (made.objects.log_pose) graph.keep("log_pose", made.objects.log_pose);
  if (made.objects.rotation) graph.keep("rotation", made.objects.rotation);
  graph.keep("code", made.objects.code);
  return made;
}

}  // namespace vkopple
