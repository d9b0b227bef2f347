#include "train/predictor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runtime/device.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

OppleOptions options_for(const Device& device) {
  return {.batch = 1, .keep_stages = true, .max_tensor_bytes = device.caps().max_tensor_bytes()};
}

/// Running averages stay as they are, so no frame need pass a network for their sake.
ModelConfig without_statistics(ModelConfig config) {
  config.statistics_frames = StatisticsFrames::kSecond;
  return config;
}

}  // namespace

Predictor::Predictor(const Device& device, const ModelConfig& config, std::shared_ptr<GroupStore> groups)
    : model_(graph_, without_statistics(config), options_for(device)),
      executor_(std::make_unique<Executor>(device, graph_, ExecutorOptions{.groups = std::move(groups)})) {
  model_.feed_constants(*executor_);
}

PredictedFrame Predictor::predict(const RgbImage& frame1, const RgbImage& frame2,
                                  const std::array<CameraPose, 3>& poses) {
  Triplets triplets;
  // Frame 3 only enters the losses, which nobody reads: any picture will do.
  for (const RgbImage* frame : {&frame1, &frame2, &frame2})
    triplets.images.insert(triplets.images.end(), frame->pixels.begin(), frame->pixels.end());
  triplets.poses.assign(poses.begin(), poses.end());
  triplets.permutation = {0};
  model_.feed(*executor_, triplets);
  executor_->forward();
  return {image("out/warped"), image("out/imagined"), image("out/predicted"), plane("out/share"),
          plane("out/predicted_depth")};
}

std::vector<float> Predictor::kept(const std::string& name) {
  std::vector<float> values = executor_->read(Value(graph_, graph_.kept().at(name)));
  if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); }))
    throw Error("what the model predicts is not a finite number; its weights are unusable, train it again");
  return values;
}

RgbImage Predictor::image(const std::string& name) {
  RgbImage out(model_.config().height, model_.config().width);
  out.pixels = kept(name);
  return out;
}

Plane<float> Predictor::plane(const std::string& name) {
  Plane<float> out(model_.config().height, model_.config().width);
  out.pixels = kept(name);
  return out;
}

double mean_squared_error(const RgbImage& a, const RgbImage& b) {
  if (a.height != b.height || a.width != b.width)
    throw Error(fmt::format("pictures of {} x {} and {} x {} pixels can't be compared", a.width, a.height,
                            b.width, b.height));
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) sum += std::pow(double{a.pixels[i]} - double{b.pixels[i]}, 2);
  return sum / static_cast<double>(a.pixels.size());
}

}  // namespace vkopple
