#include "models/perception.h"

#include "models/perception_graph.h"
#include "runtime/device.h"

namespace vkopple {

Perception::Perception(const Device& device, const ModelConfig& config, std::shared_ptr<GroupStore> groups,
                       const PerceptionOptions& options)
    : config_(config), options_(options) {
  graph_.store_activations(activation_storage(options.precision));
  const PerceptionGraph made =
      perception_graph(graph_, config, options.batch, options.objects, device.caps().max_tensor_bytes());
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
    percepts.location = executor_->read(objects_.location);
    percepts.code = executor_->read(objects_.code);
    if (objects_.log_pose) percepts.log_pose = executor_->read(objects_.log_pose);
    if (objects_.rotation) percepts.rotation = executor_->read(objects_.rotation);
  }
  return percepts;
}

}  // namespace vkopple
