#include "models/model_check.h"

#include <cmath>
#include <functional>
#include <random>

#include "graph/executor.h"
#include "models/opple.h"
#include "runtime/device.h"

namespace vkopple {
namespace {

constexpr int64_t kBatch = 3;
/// How far the loss should move, as a fraction of it: a thousand of its float32 spacings, and still along a
/// straight line. Where a network's part in the loss is small, kinks bend it soon: differences that are within
/// 1.4 % of the derivative here are 5 % off at three times the distance and 19 % at ten times.
constexpr double kMove = 1e-4;
constexpr double kLimit = 0.02;

ModelConfig small_model() {
  ModelConfig config;
  config.height = 32;
  config.width = 32;
  config.depth_width = 4;
  config.object_width = 4;
  config.imagine_width = 2;
  config.lstm = 16;
  config.bins = 24;
  return config;
}

/// Smooth textures that move a little from frame to frame.
Triplets made_up(const ModelConfig& config) {
  Triplets t;
  for (int frame = 0; frame < 3; ++frame)
    for (int64_t b = 0; b < kBatch; ++b) {
      for (int c = 0; c < 3; ++c)
        for (int y = 0; y < config.height; ++y)
          for (int x = 0; x < config.width; ++x) {
            const double u = 0.3 * x + 0.15 * frame + static_cast<double>(b);
            const double v = 0.4 * y + 0.7 * c;
            t.images.push_back(
                static_cast<float>(0.5 + 0.25 * std::sin(u + 0.5 * std::sin(v)) + 0.2 * std::cos(v - 0.3 * u)));
          }
      // Only turns in space are told of pitch and roll.
      const double tilt = config.orientation == Orientation::kEuler ? 0.03 * frame : 0;
      t.poses.push_back(CameraPose{0.03 * frame, 0.05 * frame, 0.7 + 0.1 * tilt,
                                   0.02 * frame * static_cast<double>(b + 1), tilt, -0.7 * tilt});
    }
  for (int64_t b = 0; b < kBatch; ++b) t.permutation.push_back(static_cast<uint32_t>((b + 1) % kBatch));
  return t;
}

class ModelCheck {
 public:
  ModelCheck(const Device& device, const ModelConfig& config)
      : config_(config),
        model_(graph_, config_,
               {.batch = kBatch, .training = false, .max_tensor_bytes = device.caps().max_tensor_bytes()}),
        executor_(device, graph_, {.loss = model_.loss(), .trained = model_.groups()}) {
    for (const InitialTensor& t : model_.tensors())
      executor_.write(t.value, initial_values(t.initial, t.value.shape().elements(), 5, t.name));
    model_.feed_constants(executor_);
    model_.feed_random(executor_, 11, 1);
    model_.feed(executor_, made_up(config_));
  }

  std::vector<DirectionalCheck> run() {
    loss();
    executor_.backward();
    std::vector<DirectionalCheck> checks;
    for (const auto& group : model_.groups()) {
      const auto gradient = executor_.read(graph_.gradient(group));
      checks.push_back(along(group, "gradient", gradient, gradient));
      std::mt19937 random(17);
      std::vector<float> direction(gradient.size());
      // A random direction, bent towards the gradient: alone it would change the loss less than its rounding.
      for (size_t i = 0; i < direction.size(); ++i)
        direction[i] =
            std::abs(gradient[i]) * (random() % 4 == 0 ? -1.0F : 1.0F) * (gradient[i] < 0 ? -1.0F : 1.0F);
      checks.push_back(along(group, "random", direction, gradient));
    }
    return checks;
  }

 private:
  double loss() {
    executor_.forward();
    return static_cast<double>(executor_.read(model_.loss())[0]);
  }

  static double dot(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    return sum;
  }

  DirectionalCheck along(const std::string& group, const std::string& name, const std::vector<float>& direction,
                         const std::vector<float>& gradient) {
    const Value all = graph_.group(group);
    const auto start = executor_.read(all);
    const double length = std::sqrt(dot(direction, direction));
    const double step = kMove * loss() / std::sqrt(dot(gradient, gradient));
    const auto at = [&](double distance) {
      std::vector<float> moved(start.size());
      for (size_t i = 0; i < moved.size(); ++i)
        moved[i] = start[i] + static_cast<float>(distance * static_cast<double>(direction[i]) / length);
      executor_.write(all, moved);
      return loss();
    };
    const double numeric = (at(step) - at(-step)) / (2 * step);
    executor_.write(all, start);
    return {.group = group,
            .direction = name,
            .analytic = dot(gradient, direction) / length,
            .numeric = numeric,
            .limit = kLimit * std::sqrt(dot(gradient, gradient))};
  }

  ModelConfig config_;
  Graph graph_;
  Opple model_;
  Executor executor_;
};

}  // namespace

bool DirectionalCheck::passed() const { return std::abs(analytic - numeric) <= limit; }

std::vector<CheckedModel> checked_models() {
  std::vector<CheckedModel> models;
  const auto add = [&](const std::string& name, const std::function<void(ModelConfig&)>& change) {
    models.push_back({name, small_model()});
    change(models.back().config);
  };
  add("statistics of all", [](ModelConfig&) {});
  add("statistics of second", [](ModelConfig& c) { c.statistics_frames = StatisticsFrames::kSecond; });
  add("masks within a window", [](ModelConfig& c) { c.mask_window = 0.8; });
  add("locations of masks", [](ModelConfig& c) {
    c.mask_location = true;
    c.mask_window = 0.8;
    c.statistics_frames = StatisticsFrames::kSecond;
  });
  add("relaxed", [](ModelConfig& c) { c.relaxed = true; });
  add("euler", [](ModelConfig& c) { c.orientation = Orientation::kEuler; });
  add("no warp, js, more terms", [](ModelConfig& c) {
    c.warp = false;
    c.pose_loss = PoseLossKind::kJs;
    c.smoothness = 0.1;
    c.pose_contrast = 0.5;
    c.slot_contrast = 0.5;
  });
  add("no regularisers", [](ModelConfig& c) { c.reg = 0; });
  const auto odd = [](ModelConfig& c) {
    c.height = 37;
    c.width = 22;
    c.fov = 1.1;
    c.slots = 5;
    c.bins = 17;
    c.code = 13;
    c.identity = 13;
  };
  add("odd sizes", odd);
  add("odd sizes, relaxed", [&](ModelConfig& c) {
    odd(c);
    std::swap(c.height, c.width);
    c.relaxed = true;
  });
  add("odd sizes, euler", [&](ModelConfig& c) {
    odd(c);
    c.slots = 1;
    c.orientation = Orientation::kEuler;
  });
  return models;
}

std::vector<DirectionalCheck> check_model(const Device& device, const ModelConfig& config) {
  return ModelCheck(device, config).run();
}

}  // namespace vkopple
