#include "train/data/shard_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "runtime/error.h"
#include "train/image_io.h"
#include "train/json_io.h"
#include "train/random.h"

namespace vkopple {
namespace {

constexpr uint32_t kMostObjects = 1000;
constexpr double kFarthest = 1e6;  // of any coordinate: floats are exact enough below

bool has_part(const SamplePlace& place, const std::string& extension) {
  return std::any_of(place.parts.begin(), place.parts.end(),
                     [&](const auto& part) { return part.extension == extension; });
}

template <std::size_t N>
std::array<double, N> coordinates(const JsonView& view) {
  const std::vector<double> values = view.numbers(N);
  std::array<double, N> result{};
  for (std::size_t i = 0; i < N; ++i) {
    if (std::abs(values[i]) > kFarthest) view.fail(fmt::format("numbers up to {}", kFarthest));
    result[i] = values[i];
  }
  return result;
}

/// One triplet of a scene on its way into a batch.
class SceneReader {
 public:
  SceneReader(const Sample& sample, const Lens& lens)
      : sample_(sample), lens_(lens), json_(parse(sample)), view_(json_, sample.where("json")) {
    const double fov = view_["fov"].number();
    if (std::abs(fov - lens.fov) > 1e-6) {
      throw Error(fmt::format("{}: fov is {} and the model's {}; give a data set of the same angle of view",
                              sample.where("json"), fov, lens.fov));
    }
  }

  RgbImage image(int frame) const {
    const std::string name = fmt::format("{}.png", frame);
    RgbImage image = decode_png(sample_.part(name), sample_.where(name));
    check_sides(image.height, image.width, name);
    return resize(image, lens_.height, lens_.width);
  }

  bool has_layers(int frame) const { return sample_.parts.contains(fmt::format("{}.exr", frame)); }

  DepthAndIds layers(int frame) const {
    const std::string name = fmt::format("{}.exr", frame);
    const DepthAndIds stored = decode_exr(sample_.part(name), sample_.where(name));
    check_sides(stored.depth.height, stored.depth.width, name);
    const bool sound = std::all_of(stored.depth.pixels.begin(), stored.depth.pixels.end(),
                                   [](float z) { return z >= 0 && z <= static_cast<float>(kFarthest); });
    if (!sound)
      throw Error(fmt::format("{}: Z is negative, not a number or over {}; generate it again",
                              sample_.where(name), kFarthest));
    const uint32_t most = *std::max_element(stored.ids.pixels.begin(), stored.ids.pixels.end());
    if (most > kMostObjects)
      throw Error(
          fmt::format("{}: objectId is {}; at most {} are read", sample_.where(name), most, kMostObjects));
    return {resize(stored.depth, lens_.height, lens_.width),
            resize_nearest(stored.ids, lens_.height, lens_.width)};
  }

  std::array<double, 6> camera(int frame) const { return coordinates<6>(frame_view(frame)["camera"]); }

  bool has_objects(int frame) const { return frame_view(frame).contains("objects"); }

  /// `ids` at the model's size.
  std::vector<ObjectTruth> objects(int frame, const Plane<uint32_t>& ids) const {
    const JsonView listed = frame_view(frame)["objects"];
    std::vector<ObjectTruth> truths;
    for (std::size_t i = 0; i < listed.size(); ++i)
      truths.push_back({coordinates<3>(listed[i]["location_in_camera"]), 0});
    for (const uint32_t id : ids.pixels) {
      if (id > truths.size()) {
        throw Error(fmt::format("{}: objectId {} is not among the {} objects of the JSON",
                                sample_.where(fmt::format("{}.exr", frame)), id, truths.size()));
      }
      if (id > 0) ++truths[id - 1].pixels;
    }
    return truths;
  }

 private:
  static Json parse(const Sample& sample) {
    const std::vector<std::byte>& bytes = sample.part("json");
    return parse_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, sample.where("json"));
  }

  JsonView frame_view(int frame) const {
    const JsonView frames = view_["frames"];
    if (frames.size() <= static_cast<std::size_t>(frame))
      frames.fail(fmt::format("a list of more than {} frames", frame));
    return frames[static_cast<std::size_t>(frame)];
  }

  void check_sides(int height, int width, const std::string& name) const {
    if (int64_t{height} * lens_.width == int64_t{width} * lens_.height) return;
    throw Error(fmt::format(
        "{}: {} x {} pixels have not the model's ratio of {} x {}; generate a data set of that shape",
        sample_.where(name), width, height, lens_.width, lens_.height));
  }

  const Sample& sample_;
  const Lens& lens_;
  Json json_;
  JsonView view_;
};

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Whether every triplet so far had depth and labels, and whether it had objects.
struct Known {
  bool layers = true, objects = true;
};

void add_triplet(const SceneReader& scene, const std::array<uint16_t, 3>& frames, TripletBatch& batch,
                 Known& known) {
  for (std::size_t k = 0; k < 3; ++k) {
    append(batch.images[k], scene.image(frames[k]).pixels);
    for (const double number : scene.camera(frames[k])) batch.poses[k].push_back(static_cast<float>(number));
  }
  const int middle = frames[1];
  known.layers = known.layers && scene.has_layers(middle);
  known.objects = known.objects && known.layers && scene.has_objects(middle);
  if (!known.layers) return;
  const DepthAndIds layers = scene.layers(middle);
  append(batch.depth, layers.depth.pixels);
  append(batch.label, layers.ids.pixels);
  if (known.objects) batch.objects.push_back(scene.objects(middle, layers.ids));
}

}  // namespace

ShardSource::ShardSource(const std::filesystem::path& path, const Lens& lens, int batch, uint64_t seed,
                         Reading reading, uint64_t parts)
    : reader_(path), lens_(lens), batch_(batch), seed_(seed), reading_(reading), parts_(parts) {
  find_triplets();
  if (triplets_.empty()) {
    throw Error(fmt::format("{}: no scene of three frames or more (KEY.0.png, KEY.1.png, ...); check the path",
                            path.string()));
  }
}

void ShardSource::find_triplets() {
  while (const auto place = reader_.next_place()) add_scene(*place);
  if (triplets_.size() > UINT32_MAX)
    throw Error(fmt::format("{} triplets are too many; split the data set", triplets_.size()));
}

void ShardSource::add_scene(const SamplePlace& place) {
  int frames = 0;
  while (has_part(place, fmt::format("{}.png", frames))) ++frames;
  const auto scene = static_cast<uint32_t>(scenes_.size());
  scenes_.push_back(place);
  const auto keep = [&](int a, int b, int c) {
    triplets_.push_back(
        {scene, {static_cast<uint16_t>(a), static_cast<uint16_t>(b), static_cast<uint16_t>(c)}});
  };
  if (reading_ == Reading::kEvaluation) {
    if (frames >= 3) keep((frames - 1) / 2 - 1, (frames - 1) / 2, (frames - 1) / 2 + 1);
    return;
  }
  for (const auto& [a, b, c] : strided_triplets(frames)) keep(a, b, c);
}

void ShardSource::shuffle(uint64_t epoch) {
  order_.resize(triplets_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  Random random(seed_, epoch);
  for (std::size_t left = order_.size(); left > 1; --left) {
    std::swap(order_[left - 1], order_[random.below(static_cast<uint32_t>(left))]);
  }
  order_epoch_ = epoch;
}

const ShardSource::Triplet& ShardSource::choose(uint64_t step, uint64_t element) {
  const uint64_t count = triplets_.size(), batch = static_cast<uint64_t>(batch_);
  if (reading_ == Reading::kEvaluation) return triplets_[(step * batch + element) % count];
  const uint64_t steps = std::max<uint64_t>(count / (batch * parts_), 1) * parts_;  // of an epoch
  if (step / steps != order_epoch_) shuffle(step / steps);
  return triplets_[order_[(step % steps * batch + element) % count]];
}

TripletBatch ShardSource::read(uint64_t step) {
  TripletBatch result;
  result.batch = batch_;
  result.height = lens_.height;
  result.width = lens_.width;
  Known known;
  for (uint64_t element = 0; element < static_cast<uint64_t>(batch_); ++element) {
    const Triplet& triplet = choose(step, element);
    std::set<std::string> wanted{"json", fmt::format("{}.exr", triplet.frames[1])};
    for (const uint16_t frame : triplet.frames) wanted.insert(fmt::format("{}.png", frame));
    const Sample sample = reader_.read(scenes_[triplet.scene], wanted);
    add_triplet(SceneReader(sample, lens_), triplet.frames, result, known);
  }
  if (!known.layers) {
    result.depth.clear();
    result.label.clear();
  }
  if (!known.objects) result.objects.clear();
  return result;
}

}  // namespace vkopple
