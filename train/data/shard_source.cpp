#include "train/data/shard_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "runtime/error.h"
#include "train/formats/shard_scene.h"
#include "train/random.h"

namespace vkopple {
namespace {

constexpr std::size_t kOrdersKept = 2;  // threads that read ahead cross the border of two epochs

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// One triplet of a scene on its way into a batch.
class TripletScene {
 public:
  TripletScene(const Sample& sample, const Lens& lens) : scene_(sample), lens_(lens) {}

  RgbImage image(int frame) const {
    const RgbImage image = scene_.image(frame);
    check_sides(image.height, image.width, fmt::format("{}.png", frame));
    return resize(image, lens_.height, lens_.width);
  }

  /// The angle of view is of no matter where there is no camera: then only what a picture shows is looked at.
  std::optional<CameraPose> camera(int frame) const {
    const auto camera = scene_.camera(frame);
    if (!camera || std::abs(scene_.fov() - lens_.fov) <= 1e-6) return camera;
    throw Error(fmt::format(
        "{}: fov is {} and the model's {}; give a data set of the same angle of view, or set model.fov",
        json_name(), scene_.fov(), lens_.fov));
  }

  CameraPose required_camera(int frame) const {
    if (const auto known = camera(frame)) return *known;
    throw Error(fmt::format("{}: frame {} has no camera pose, which training needs", json_name(), frame));
  }

  /// At the model's size. Planes of what is unknown have no pixels.
  DepthAndIds layers(int frame) const {
    DepthAndIds known;
    if (!scene_.has_layers(frame)) return known;
    known = scene_.layers(frame);
    if (!known.depth.pixels.empty()) {
      check_sides(known.depth.height, known.depth.width, exr(frame));
      known.depth = resize_depth(known.depth, lens_.height, lens_.width);
    }
    if (!known.ids.pixels.empty()) {
      check_sides(known.ids.height, known.ids.width, exr(frame));
      known.ids = resize_nearest(known.ids, lens_.height, lens_.width);
    }
    return known;
  }

  /// Objects have places in the camera's frame only where there is a camera.
  bool has_objects(int frame) const { return scene_.has_objects(frame) && scene_.camera(frame); }

  /// `ids` at the model's size.
  std::vector<ObjectTruth> objects(int frame, const Plane<uint32_t>& ids) const {
    std::vector<ObjectTruth> truths;
    for (const auto& location : scene_.locations_in_camera(frame)) truths.push_back({location, 0});
    const auto yaws = scene_.yaws_in_camera(frame);
    for (std::size_t i = 0; i < truths.size(); ++i) truths[i].yaw = yaws[i];
    for (const uint32_t id : ids.pixels) {
      if (id > truths.size())
        throw Error(fmt::format("{}: objectId {} is not among the {} objects of the JSON",
                                scene_.sample().where(exr(frame)), id, truths.size()));
      if (id > 0) ++truths[id - 1].pixels;
    }
    return truths;
  }

 private:
  std::string json_name() const { return scene_.sample().where("json"); }
  static std::string exr(int frame) { return fmt::format("{}.exr", frame); }

  void check_sides(int height, int width, const std::string& name) const {
    if (int64_t{height} * lens_.width == int64_t{width} * lens_.height) return;
    throw Error(fmt::format(
        "{}: {} x {} pixels have not the model's ratio of {} x {}; crop them by vkopple convert, or "
        "give a data set of that shape",
        scene_.sample().where(name), width, height, lens_.width, lens_.height));
  }

  ShardScene scene_;
  const Lens& lens_;
};

/// What is known of some triplet of a batch, or for cameras of all.
struct Known {
  bool cameras = true, depth = false, ids = false, objects = false;
};

void add_images(const TripletScene& scene, const std::array<uint16_t, 3>& frames, TripletBatch& batch) {
  for (std::size_t k = 0; k < 3; ++k) append(batch.images[k], scene.image(frames[k]).pixels);
}

void add_cameras(const TripletScene& scene, const std::array<uint16_t, 3>& frames, bool required,
                 TripletBatch& batch, Known& known) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto camera = required ? scene.required_camera(frames[k]) : scene.camera(frames[k]);
    known.cameras = known.cameras && camera;
    for (const double number : camera.value_or(CameraPose{}))
      batch.poses[k].push_back(static_cast<float>(number));
  }
}

/// A plane, or as many of `unknown` where it has no pixels. Whether it has.
template <class T>
bool append_known(const Plane<T>& plane, std::size_t area, T unknown, std::vector<T>& to) {
  const bool known = !plane.pixels.empty();
  append(to, known ? plane.pixels : std::vector<T>(area, unknown));
  return known;
}

void add_truth(const TripletScene& scene, int middle, TripletBatch& batch, Known& known) {
  const DepthAndIds layers = scene.layers(middle);
  const auto area = static_cast<std::size_t>(batch.height) * static_cast<std::size_t>(batch.width);
  const bool has_depth = append_known(layers.depth, area, 0.0f, batch.depth);
  const bool has_ids = append_known(layers.ids, area, kUnknownLabel, batch.label);
  const bool has_objects = has_ids && scene.has_objects(middle);
  batch.objects.push_back(has_objects ? scene.objects(middle, layers.ids) : std::vector<ObjectTruth>{});
  known.depth = known.depth || has_depth;
  known.ids = known.ids || has_ids;
  known.objects = known.objects || has_objects;
}

/// A pose that is unknown of one triplet is left out of all, and so is what nothing is known of.
void keep_known(const Known& known, TripletBatch& batch) {
  if (!known.cameras)
    for (auto& poses : batch.poses) poses.clear();
  if (!known.depth) batch.depth.clear();
  if (!known.ids) batch.label.clear();
  if (!known.objects) batch.objects.clear();
}

}  // namespace

ShardSource::ShardSource(std::unique_ptr<SampleStore> store, const std::filesystem::path& path,
                         const Lens& lens, int batch, uint64_t seed, Reading reading, uint64_t parts)
    : store_(std::move(store)), lens_(lens), batch_(batch), seed_(seed), reading_(reading), parts_(parts) {
  find_triplets();
  if (!triplets_.empty()) return;
  throw Error(fmt::format("{}: no scene of {} (KEY.0.png, KEY.1.png, ...); check the path", path.string(),
                          reading == Reading::kTraining ? "three frames or more" : "any frames"));
}

void ShardSource::find_triplets() {
  for (std::size_t scene = 0; scene < store_->size(); ++scene) add_scene(scene);
  if (triplets_.size() > UINT32_MAX)
    throw Error(fmt::format("{} triplets are too many; split the data set", triplets_.size()));
}

void ShardSource::add_scene(std::size_t scene) {
  int frames = 0;
  while (store_->has(scene, fmt::format("{}.png", frames))) ++frames;
  const auto keep = [&](int a, int b, int c) {
    triplets_.push_back({static_cast<uint32_t>(scene),
                         {static_cast<uint16_t>(a), static_cast<uint16_t>(b), static_cast<uint16_t>(c)}});
  };
  if (reading_ == Reading::kEvaluation) {
    const int middle = (frames - 1) / 2;
    if (frames > 0) keep(std::max(middle - 1, 0), middle, std::min(middle + 1, frames - 1));
    return;
  }
  for (const auto& [a, b, c] : strided_triplets(frames)) keep(a, b, c);
}

std::shared_ptr<const ShardSource::Order> ShardSource::order(uint64_t epoch) {
  const std::lock_guard lock(orders_mutex_);
  if (const auto found = orders_.find(epoch); found != orders_.end()) return found->second;
  const auto order = std::make_shared<Order>(triplets_.size());
  std::iota(order->begin(), order->end(), 0U);
  Random random(seed_, epoch);
  for (std::size_t left = order->size(); left > 1; --left)
    std::swap((*order)[left - 1], (*order)[random.below(static_cast<uint32_t>(left))]);
  orders_[epoch] = order;
  if (orders_.size() > kOrdersKept)
    orders_.erase(orders_.begin()->first == epoch ? std::prev(orders_.end()) : orders_.begin());
  return order;
}

std::vector<ShardSource::Triplet> ShardSource::choose(uint64_t step) {
  const uint64_t count = triplets_.size(), batch = static_cast<uint64_t>(batch_);
  std::vector<Triplet> chosen;
  if (reading_ == Reading::kEvaluation) {
    for (uint64_t i = 0; i < batch; ++i) chosen.push_back(triplets_[(step * batch + i) % count]);
    return chosen;
  }
  const uint64_t steps = std::max<uint64_t>(count / (batch * parts_), 1) * parts_;  // of an epoch
  const auto epoch_order = order(step / steps);
  for (uint64_t i = 0; i < batch; ++i)
    chosen.push_back(triplets_[(*epoch_order)[(step % steps * batch + i) % count]]);
  return chosen;
}

TripletBatch ShardSource::read(uint64_t step, bool truth) {
  TripletBatch result;
  result.batch = batch_;
  result.height = lens_.height;
  result.width = lens_.width;
  Known known;
  for (const Triplet& triplet : choose(step)) {
    std::set<std::string> wanted{"json"};
    if (truth) wanted.insert(fmt::format("{}.exr", triplet.frames[1]));
    for (const uint16_t frame : triplet.frames) wanted.insert(fmt::format("{}.png", frame));
    const Sample sample = store_->read(triplet.scene, wanted);
    const TripletScene scene(sample, lens_);
    add_images(scene, triplet.frames, result);
    add_cameras(scene, triplet.frames, reading_ == Reading::kTraining, result, known);
    if (truth) add_truth(scene, triplet.frames[1], result, known);
  }
  keep_known(known, result);
  return result;
}

}  // namespace vkopple
