#include "train/parity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "graph/ops/adam.h"
#include "models/opple.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

constexpr double kLeastLimit = 1e-4;
constexpr double kNoiseFactor = 5;
/// Of the trajectory (the fixtures' README): Adam at 3e-4, eps 1e-6, clipped by value to 1, the depth network
/// to 2.5.
constexpr float kLearningRate = 3e-4F;
constexpr float kEpsilon = 1e-6F;

/// Scene i of a rolled batch is scene (i - roll) mod B; only the first `count` are taken.
template <class T>
std::vector<T> rolled(const std::vector<T>& values, size_t scenes, size_t roll, size_t count) {
  const size_t each = values.size() / scenes;
  std::vector<T> out;
  for (size_t i = 0; i < count; ++i) {
    const size_t from = (i + scenes - roll % scenes) % scenes;
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(from * each);
    out.insert(out.end(), begin, begin + static_cast<std::ptrdiff_t>(each));
  }
  return out;
}

class Parity {
 public:
  Parity(const Device& device, const std::filesystem::path& path) : device_(device), file_(path) {
    const auto& metadata = file_.metadata();
    if (!metadata.contains("config") || !metadata.contains("mode"))
      throw Error(fmt::format("{}: not a parity fixture, its metadata has no config and mode", path.string()));
    config_ = ModelConfig::parse(metadata.at("config"), path.string());
    training_ = metadata.at("mode") == "train";
    const auto& shape = file_.shape("input/image1");
    if (shape != StoredShape{shape.empty() ? 0 : shape[0], 3, config_.height, config_.width})
      throw Error(fmt::format("{}: input/image1 has shape {}, not (B, 3, {}, {})", path.string(),
                              to_string(shape), config_.height, config_.width));
    scenes_ = static_cast<size_t>(shape[0]);
  }

  ParityReport run() {
    run_once();
    if (file_.contains("trajectory/total")) run_trajectory();
    for (const auto& name : file_.names()) compare(name);
    return std::move(report_);
  }

 private:
  struct Built {
    Graph graph;
    std::optional<Opple> model;
    std::unique_ptr<Executor> executor;
  };

  std::unique_ptr<Built> build(size_t batch, bool keep_stages, bool update) {
    auto built = std::make_unique<Built>();
    built->model.emplace(built->graph, config_,
                         OppleOptions{.batch = static_cast<int64_t>(batch),
                                      .training = training_,
                                      .keep_stages = keep_stages,
                                      .max_tensor_bytes = device_.caps().max_tensor_bytes()});
    const auto groups = built->model->groups();
    const Value rate = learning_rate(built->graph);
    for (const auto& group : groups)
      if (update)
        adam(built->graph, group, {.epsilon = kEpsilon, .clip = group == "depth" ? 2.5F : 1.0F}, rate);
    built->executor = std::make_unique<Executor>(
        device_, built->graph, ExecutorOptions{.loss = built->model->loss(), .trained = groups});
    for (const InitialTensor& t : built->model->tensors()) {
      const bool average = t.name.ends_with(".running_mean") || t.name.ends_with(".running_var");
      built->executor->write(t.value, weights((average ? "buffer/" : "param/") + t.name, t.value.shape()));
    }
    built->executor->write(rate, std::vector<float>{kLearningRate});
    built->model->feed_constants(*built->executor);
    return built;
  }

  /// 1×1 convolutions may be stored as matrices, without their last two sizes.
  std::vector<float> weights(const std::string& name, const Shape& shape) const {
    StoredShape sizes(shape.sizes().begin(), shape.sizes().end());
    if (sizes.size() == 4 && sizes[2] == 1 && sizes[3] == 1 && file_.shape(name).size() == 2) sizes.resize(2);
    return file_.read_floats(name, sizes);
  }

  Triplets triplets(size_t roll, size_t count) const {
    Triplets t;
    for (int frame = 1; frame <= 3; ++frame) {
      const auto images = rolled(file_.read_floats(fmt::format("input/image{}", frame)), scenes_, roll, count);
      t.images.insert(t.images.end(), images.begin(), images.end());
      const auto poses = rolled(file_.read_doubles(fmt::format("input/pose{}", frame)), scenes_, roll, count);
      for (size_t i = 0; i < count; ++i) {
        CameraPose pose{};
        std::copy_n(poses.begin() + static_cast<std::ptrdiff_t>(6 * i), 6, pose.begin());
        t.poses.push_back(pose);
      }
    }
    for (int64_t p : file_.read_ints("input/permutation")) t.permutation.push_back(static_cast<uint32_t>(p));
    return t;
  }

  void store(const std::string& name, std::vector<float> values, const Shape& shape) {
    if (!file_.contains(name)) return;
    StoredShape sizes(shape.sizes().begin(), shape.sizes().end());
    const StoredShape& wanted = file_.shape(name);
    if (element_count(wanted) == static_cast<int64_t>(values.size()))
      sizes = wanted;  // (B, 1, H, W) as (B, H, W)
    report_.computed.emplace(name, StoredTensor::of(sizes, std::span<const float>(values)));
  }

  void run_once() {
    const auto built = build(scenes_, true, false);
    built->model->feed(*built->executor, triplets(0, scenes_));
    built->executor->forward();
    built->executor->backward();
    for (const auto& [name, id] : built->graph.kept()) {
      const Value value(built->graph, id);
      auto values = built->executor->read(value);
      if (name.ends_with("mask_logits")) values = slots_last(values, value.shape());
      store(name, std::move(values), value.shape());
    }
    for (const InitialTensor& t : built->model->tensors()) {
      const bool average = t.name.ends_with(".running_mean") || t.name.ends_with(".running_var");
      store((average ? "buffer_after/" : "grad/") + t.name,
            average ? built->executor->read(t.value) : built->executor->read_gradient(t.value),
            t.value.shape());
    }
  }

  /// (K, B, …) to (B, K, …)
  static std::vector<float> slots_last(const std::vector<float>& values, const Shape& shape) {
    const auto slots = static_cast<size_t>(shape[0]);
    const auto batch = static_cast<size_t>(shape[1]);
    const size_t pixels = values.size() / (slots * batch);
    std::vector<float> out(values.size());
    for (size_t k = 0; k < slots; ++k)
      for (size_t b = 0; b < batch; ++b)
        std::copy_n(values.begin() + static_cast<std::ptrdiff_t>((k * batch + b) * pixels), pixels,
                    out.begin() + static_cast<std::ptrdiff_t>((b * slots + k) * pixels));
    return out;
  }

  void run_trajectory() {
    const auto steps = static_cast<size_t>(file_.shape("trajectory/total").at(0));
    const size_t batch = scenes_ - 1;
    const auto built = build(batch, false, true);
    std::vector<float> totals;
    for (size_t step = 0; step < steps; ++step) {
      Triplets t = triplets(step, batch);
      t.permutation.resize(batch);
      for (size_t i = 0; i < batch; ++i) t.permutation[i] = static_cast<uint32_t>((i + batch - 1) % batch);
      built->model->feed(*built->executor, t);
      built->executor->forward();
      totals.push_back(built->executor->read(built->model->loss())[0]);
      built->executor->backward();
      built->executor->update();
    }
    store("trajectory/total", totals, Shape{static_cast<int64_t>(steps)});
  }

  void compare(const std::string& name) {
    const std::string group = name.substr(0, name.find('/'));
    if (group == "noise" || group == "param" || group == "buffer" || group == "input") return;
    const auto found = report_.computed.find(name);
    if (found == report_.computed.end())
      throw Error(fmt::format("{}: the model computes no {}", file_.path().string(), name));
    if (found->second.shape != file_.shape(name))
      throw Error(fmt::format("{}: {} has shape {}, the model's has {}", file_.path().string(), name,
                              to_string(file_.shape(name)), to_string(found->second.shape)));
    const auto want = file_.read_doubles(name);
    const auto got = to_doubles(found->second);
    double difference = 0;
    double norm = 0;
    for (size_t i = 0; i < want.size(); ++i) {
      difference += (got[i] - want[i]) * (got[i] - want[i]);
      norm += want[i] * want[i];
    }
    const double noise = file_.read_doubles("noise/" + name).at(0);
    report_.entries.push_back({.name = name,
                               .error = std::sqrt(difference) / (std::sqrt(norm) + 1e-30),
                               .noise = noise,
                               .limit = std::max(kLeastLimit, kNoiseFactor * noise)});
  }

  const Device& device_;
  SafetensorsFile file_;
  ModelConfig config_;
  bool training_ = false;
  size_t scenes_ = 0;
  ParityReport report_;
};

}  // namespace

bool ParityReport::passed() const {
  return std::all_of(entries.begin(), entries.end(), [](const ParityEntry& e) { return e.passed(); });
}

std::map<std::string, ParityEntry> ParityReport::worst() const {
  std::map<std::string, ParityEntry> worst;
  for (const ParityEntry& entry : entries) {
    const auto [found, added] = worst.try_emplace(entry.name.substr(0, entry.name.find('/')), entry);
    if (!added && !(entry.error / entry.limit <= found->second.error / found->second.limit))
      found->second = entry;
  }
  return worst;
}

ParityReport check_parity(const Device& device, const std::filesystem::path& fixture) {
  return Parity(device, fixture).run();
}

}  // namespace vkopple
