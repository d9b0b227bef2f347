#include "models/perception.h"

#include "graph/ops/relayout.h"
#include "models/depth_net.h"
#include "models/network_options.h"
#include "models/object_net.h"
#include "runtime/device.h"

namespace vkopple {

Perception::Perception(const Device& device, const ModelConfig& config, std::shared_ptr<GroupStore> groups,
                       const PerceptionOptions& options)
    : config_(config), options_(options) {
  graph_.store_activations(activation_storage(options.precision));
  const uint64_t largest = device.caps().max_tensor_bytes();
  const auto use = [&](LayerFactory& layers) {
    tensors_.insert(tensors_.end(), layers.tensors().begin(), layers.tensors().end());
  };
  images_ = graph_.input("images", row_major({options.batch, 3, config.height, config.width}));
  const Value images4 = to_channels4(images_);
  LayerFactory depth(graph_, network_options(config, "depth", false, {}, largest));
  depth_ = depth_net(depth, config, images4);
  use(depth);
  graph_.keep("depth", depth_);
  if (options.objects) {
    LayerFactory layers(graph_, network_options(config, "object", false, {}, largest));
    const ObjectOutputs out = object_net(layers, config, images4, {true}).front();
    use(layers);
    objects_ = object_state(config, out.raw, out.mask_logits);
    graph_.keep("masks", objects_.masks);
    graph_.keep("location", objects_.location);
    if (objects_.log_pose) graph_.keep("log_pose", objects_.log_pose);
    if (objects_.rotation) graph_.keep("rotation", objects_.rotation);
  }
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
    if (objects_.log_pose) percepts.log_pose = executor_->read(objects_.log_pose);
    if (objects_.rotation) percepts.rotation = executor_->read(objects_.rotation);
  }
  return percepts;
}

}  // namespace vkopple
