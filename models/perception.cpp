#include "models/perception.h"

#include "models/perception_graph.h"
#include "runtime/device.h"

namespace vkopple {

namespace {

PerceptionGraph build(Graph& graph, const Caps& caps, const ModelConfig& config,
                      const PerceptionOptions& options) {
  graph.store_activations(activation_storage(options.precision));
  return perception_graph(graph, config, options.batch, options.objects, caps.max_tensor_bytes());
}

}  // namespace

uint64_t perception_bytes(const Caps& caps, const ModelConfig& config, const PerceptionOptions& options) {
  Graph graph;
  build(graph, caps, config, options);
  return plan_execution(caps, graph, {}).own_bytes();
}

Perception::Perception(const Device& device, const ModelConfig& config, std::shared_ptr<GroupStore> groups,
                       const PerceptionOptions& options)
    : config_(config), options_(options) {
  const PerceptionGraph made = build(graph_, device.caps(), config, options);
  tensors_ = made.tensors;
  images_ = made.images;
  depth_ = made.depth;
  objects_ = made.objects;
  executor_ = std::make_unique<Executor>(
      device, graph_, ExecutorOptions{.groups = std::move(groups), .profile = options.profile});
}

Percepts Perception::see(std::span<const float> images) {
  executor_->write(images_, images);
  executor_->forward();
  Percepts percepts;
  percepts.depth = executor_->read(depth_);
  if (options_.objects) {
    percepts.masks = executor_->read(objects_.masks);
    percepts.location = executor_->read(objects_.place());
    percepts.code = executor_->read(objects_.code);
    if (objects_.log_pose) percepts.log_pose = executor_->read(objects_.log_pose);
    if (objects_.rotation) percepts.rotation = executor_->read(objects_.rotation);
  }
  return percepts;
}

}  // namespace vkopple
