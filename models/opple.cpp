#include "models/opple.h"

#include <fmt/format.h>

#include "graph/ops/affine.h"
#include "graph/ops/back_project.h"
#include "graph/ops/blend.h"
#include "graph/ops/collapse_loss.h"
#include "graph/ops/gather_batch.h"
#include "graph/ops/image_loss.h"
#include "graph/ops/imagination_condition.h"
#include "graph/ops/imagination_input.h"
#include "graph/ops/imagination_mix.h"
#include "graph/ops/location_loss.h"
#include "graph/ops/mask_centroid.h"
#include "graph/ops/move_background.h"
#include "graph/ops/pose_contrast.h"
#include "graph/ops/project.h"
#include "graph/ops/reduce_sum.h"
#include "graph/ops/relayout.h"
#include "graph/ops/slice.h"
#include "graph/ops/slot_contrast.h"
#include "graph/ops/smoothness_loss.h"
#include "graph/ops/splat.h"
#include "graph/ops/warp_share.h"
#include "graph/ops/weighted_sum.h"
#include "models/depth_net.h"
#include "models/imagination_net.h"
#include "models/network_options.h"
#include "models/object_net.h"
#include "models/squared_difference.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr int64_t kFrames = 3;

float as_float(double value) { return static_cast<float>(value); }

/// How far slots' locations are from their masks' centroids: the mean over B, K and 3 of the squares (§6).
Value centre_loss(const ObjectState& state, Value points) {
  const Value centroid = state.centroid ? state.centroid : mask_centroid(state.masks, points);
  const Value squares = squared_difference(centroid, state.location);
  return affine(reduce_sum(squares, {0, 1, 2}), 1.0F / static_cast<float>(squares.shape().elements()), 0);
}

}  // namespace

Opple::Opple(Graph& graph, const ModelConfig& config, const OppleOptions& options)
    : graph_(&graph), config_(config), options_(options) {
  graph.store_activations(activation_storage(options.precision));
  declare_inputs();
  if (options.background_only)
    build_background_only();
  else
    build_all();
}

void Opple::declare_inputs() {
  const int64_t b = options_.batch;
  Graph& g = *graph_;
  images_ = g.input("images", row_major({kFrames * b, 3, config_.height, config_.width}));
  image2_ = take_outer(images_, b, b);
  image3_ = take_outer(images_, 2 * b, b);
  random_ = g.state("random", "random", unsigned_ints({2}));
  camera_ = CameraMotion(g, config_, b, options_.background_only);
  if (options_.background_only) return;
  permutation_ =
      g.input("permutation", unsigned_ints({several(options_.peers) ? b * options_.peers->count() : b}));
}

LayerFactory& Opple::factory(const std::string& group) {
  const auto found = factories_.find(group);
  if (found != factories_.end()) return found->second;
  NetworkOptions network =
      network_options(config_, group, options_.training, random_, options_.max_tensor_bytes);
  if (options_.sync_batch_norm) network.statistics_peers = options_.peers;
  return factories_.emplace(group, LayerFactory(*graph_, network)).first->second;
}

/// The depth network alone: the warped image, and where nothing lands the frame before.
void Opple::build_background_only() {
  const Value depth = depth_net(factory("depth"), config_, to_channels4(image2_));
  const Value points = back_project(depth, as_float(config_.fov));
  const Value moved = move_background(points, camera_.m23);
  Graph& g = *graph_;
  const Value ones = g.input("ones", row_major({options_.batch, 1, config_.height, config_.width}));
  const auto warp = splat(image2_, project(moved, as_float(config_.fov)), ones, as_float(config_.beta));
  share_ = warp_share(warp[2], true);
  predicted_ = blend(share_, warp[0], image2_);
  keep("depth", depth);
  keep("predicted", predicted_);
  losses_["image"] = image_loss(predicted_, image3_);
  losses_["total"] = losses_["image"];
  loss_ = losses_["total"];
  for (const auto& [name, value] : losses_) g.keep("loss/" + name, value);
}

/// Which of the three frames pass depth network and mask decoder.
std::vector<bool> Opple::seen_fully() const {
  const bool all = config_.statistics_frames == StatisticsFrames::kAll;
  return {all || config_.mask_location, true, all};
}

/// The frames' depths, empty where a frame doesn't pass the network. Losses read frame 2's; the others pass it
/// for their part in its running averages alone, in calls of their own, so that backward leaves them out; with
/// `mask_location` motion reads frame 1's too.
std::vector<Value> Opple::see_depth(Value images4) {
  const int64_t b = options_.batch;
  const auto frames = seen_fully();
  std::vector<Value> depths(kFrames);
  for (int64_t f = 0; f < kFrames; ++f) {
    const auto frame = static_cast<size_t>(f);
    if (frames[frame]) depths[frame] = depth_net(factory("depth"), config_, take_outer(images4, f * b, b));
  }
  return depths;
}

std::vector<ObjectState> Opple::see_objects(Value images4, const std::vector<Value>& depths) {
  std::vector<ObjectState> states;
  for (const ObjectOutputs& out : object_net(factory("object"), config_, images4, seen_fully()))
    states.push_back(object_state(config_, out.raw, out.mask_logits, depths[states.size()]));
  return states;
}

void Opple::build_all() {
  const float fov = as_float(config_.fov);
  const Value images4 = to_channels4(images_);
  const auto depths = see_depth(images4);
  const Value depth = depths[1];
  const auto o = see_objects(images4, depths);
  LayerFactory* const learned = config_.relaxed ? &factory("motion") : nullptr;
  const ObjectMotion motion = object_motion(config_, o[0], o[1], camera_, learned);

  const Value points2 = back_project(depth, fov);
  const Value points3 = moved_pixels(o[1], motion, camera_, learned, points2);
  const auto warp = splat(image2_, project(points3, fov), o[1].masks, as_float(config_.beta));
  warped_ = warp[0];
  warped_depth_ = warp[1];
  share_ = warp_share(warp[2], config_.warp);
  imagine(o[1], depth, motion);
  predicted_ = blend(share_, warped_, imagined_);
  const Value predicted_depth = blend(share_, warped_depth_, imagined_depth_);
  add_losses(o, motion, points2);

  for (size_t f = 0; f < o.size(); ++f) keep_objects(fmt::format("o{}", f + 1), o[f]);
  const std::map<std::string, Value> stages{{"depth", depth},
                                            {"points2", points2},
                                            {"points3", points3},
                                            {"q12", motion.q},
                                            {"velocity", motion.velocity},
                                            {"omega", motion.omega},
                                            {"direction", motion.direction},
                                            {"turn_vector", motion.turn_vector},
                                            {"location3", motion.predicted.location},
                                            {"log_pose3", motion.predicted.log_pose},
                                            {"rotation3", motion.predicted.rotation},
                                            {"warped", warped_},
                                            {"warped_depth", warped_depth_},
                                            {"share", share_},
                                            {"imagined", imagined_},
                                            {"imagined_depth", imagined_depth_},
                                            {"predicted", predicted_},
                                            {"predicted_depth", predicted_depth}};
  for (const auto& [name, value] : stages) keep(name, value);
}

void Opple::imagine(const ObjectState& o2, Value depth, const ObjectMotion& motion) {
  const Value x = imagination_input(image2_, depth, o2.masks);
  const Value turn = motion.turn_vector ? motion.turn_vector : motion.direction;
  const Value condition = imagination_condition(camera_.ego23, motion.velocity, turn);
  const Value y = imagination_net(factory("imagination"), config_, x, condition);
  const auto mixed = imagination_mix(y, config_.slots + 1, as_float(config_.max_depth));
  imagined_ = mixed[0];
  imagined_depth_ = mixed[1];
}

void Opple::add_losses(const std::vector<ObjectState>& o, const ObjectMotion& motion, Value points2) {
  const Scope scope(*graph_, "losses");
  const Matching matching = match_objects(config_, o[1], o[2]);
  const ObjectState predicted = in_order_of(matching, motion.predicted);
  losses_["image"] = image_loss(predicted_, image3_);
  losses_["centre"] = centre_loss(o[1], points2);
  losses_["location"] = location_loss(predicted.location, o[2].location, matching.q);
  losses_["pose"] = orientation_loss(config_, predicted, o[2], matching.q);
  // Terms that join scenes need the whole batch, which may be of several processes.
  const auto whole_batch = [&](Value part) { return gather_batch(part, options_.peers); };
  const Value whole_q = whole_batch(matching.q);
  losses_["collapse"] =
      collapse_loss(whole_batch(o[0].location), whole_batch(o[2].location), whole_q, permutation_);
  const double reg = config_.reg;
  std::vector<Value> terms{losses_["image"]};
  std::vector<float> factors{1.0F};
  const auto weigh = [&](const std::string& name, double factor) {
    terms.push_back(losses_.at(name));
    factors.push_back(as_float(factor));
  };
  for (const char* name : {"centre", "location", "pose", "collapse"}) weigh(name, reg);
  if (config_.smoothness > 0) {
    losses_["smoothness"] = smoothness_loss(o[1].masks);
    weigh("smoothness", reg * config_.smoothness);
  }
  if (config_.pose_contrast > 0) {
    losses_["pose_contrast"] = pose_contrast(whole_batch(o[0].log_pose), whole_batch(o[2].log_pose), whole_q,
                                             permutation_, pose_divergence(config_));
    weigh("pose_contrast", reg * config_.pose_contrast);
  }
  if (config_.slot_contrast > 0) {
    losses_["slot_contrast"] = slot_contrast(o[1].location);
    weigh("slot_contrast", reg * config_.slot_contrast);
  }
  losses_["total"] = weighted_sum(terms, factors);
  loss_ = losses_["total"];
  for (const auto& [name, value] : losses_) graph_->keep("loss/" + name, value);
}

void Opple::keep(const std::string& name, Value value) {
  if (value && options_.keep_stages) graph_->keep("out/" + name, value);
}

void Opple::keep_objects(const std::string& name, const ObjectState& state) {
  keep(name + ".location", state.location);
  keep(name + ".log_pose", state.log_pose);
  keep(name + ".code", state.code);
  keep(name + ".rotation", state.rotation);
  keep(name + ".mask_logits", state.mask_logits);
  keep(name + ".masks", state.masks);
  keep(name + ".centroid", state.centroid);
}

std::vector<InitialTensor> Opple::tensors() const {
  std::vector<InitialTensor> all;
  for (const auto& [group, layers] : factories_)
    all.insert(all.end(), layers.tensors().begin(), layers.tensors().end());
  return all;
}

std::vector<std::string> Opple::groups() const {
  std::vector<std::string> names;
  for (const auto& [group, layers] : factories_) names.push_back(group);
  return names;
}

void Opple::feed_images(Executor& executor, const Triplets& triplets) const {
  if (!triplets.drawn) {
    executor.write(images_, triplets.images);
    return;
  }
  const uint64_t frame = sizeof(float) * static_cast<uint64_t>(images_.shape().elements()) / kFrames;
  if (triplets.drawn.bytes != frame * static_cast<uint64_t>(kFrames - first_frame()))
    throw Error(fmt::format("{} bytes of images were drawn for frames of {}", triplets.drawn.bytes, frame));
  executor.write_end(images_, triplets.drawn);
}

void Opple::feed(Executor& executor, const Triplets& triplets) const {
  const auto b = static_cast<size_t>(options_.batch);
  if (triplets.poses.size() != 3 * b)
    throw Error(fmt::format("{} camera poses were given for a batch of {}; three each are needed",
                            triplets.poses.size(), b));
  feed_images(executor, triplets);
  camera_.feed(executor, triplets.poses);
  if (options_.background_only) return;
  executor.write_words(permutation_, triplets.permutation);
}

void Opple::feed_constants(Executor& executor) const {
  if (options_.background_only) {
    const Value ones = graph_->find("ones");
    executor.write(ones, std::vector<float>(static_cast<size_t>(ones.shape().elements()), 1.0F));
    return;
  }
  camera_.feed_constants(executor);
}

void Opple::feed_random(Executor& executor, uint32_t seed, uint32_t step) const {
  executor.write_words(random_, std::vector<uint32_t>{seed, step});
}

}  // namespace vkopple
