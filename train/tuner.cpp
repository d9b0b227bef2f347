#include "train/tuner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include "graph/conv/convolution.h"
#include "graph/conv/weight_gradient.h"
#include "graph/ops/conv2d.h"
#include "graph/ops/conv_transpose2d.h"
#include "graph/tensor.h"

namespace vkopple {
namespace {

constexpr double kWorthAChange = 0.97;

struct Convolution {
  ConvShape shape;
  ConvStorage storage;
};

/// The convolution that a node is, or whose transposed it is.
std::optional<Convolution> convolution_of(const Graph& graph, const Node& node) {
  const auto* conv = dynamic_cast<const Conv2d*>(node.op.get());
  if (conv == nullptr && dynamic_cast<const ConvTranspose2d*>(node.op.get()) == nullptr) return std::nullopt;
  const TensorSpec& in = graph.info(node.inputs[0]).spec;
  const TensorSpec& out = graph.info(node.outputs[0]).spec;
  const Shape& w = graph.info(node.inputs[1]).spec.shape;
  if (conv != nullptr) return Convolution{conv->shape_of(in.shape, w), {.x = in.storage, .y = out.storage}};
  return Convolution{ConvTranspose2d::convolution_of(in.shape, w), {.x = out.storage, .y = in.storage}};
}

/// Operands of a case on the device, of the magnitude that training's have.
class Operands {
 public:
  Operands(const Device& device, const TuningCase& tuned)
      : device_(device), case_(tuned), arena_(device, MemoryKind::kDevice, "tuning") {
    const ConvShape& s = tuned.shape;
    x_ = place(stored_as(channels4({s.n, s.ci, s.h, s.w}), tuned.storage.x));
    y_ = place(stored_as(channels4({s.n, s.co, s.ho, s.wo}), tuned.storage.y));
    w_ = place(row_major({s.co, s.ci, s.kernel, s.kernel}));
    const uint64_t scratch =
        tuned.direction ? conv_product_scratch(s, *tuned.direction) : weight_gradient_scratch(s, device.caps());
    scratch_ = arena_.allocate(scratch);
  }

  void record(Recorder& recorder) const {
    if (!case_.direction) return record_weight_gradient(recorder, case_.shape, x_, y_, w_, 0, scratch_);
    const bool forward = *case_.direction == ConvDirection::kForward;
    record_conv_product(recorder, case_.shape, *case_.direction,
                        {.in = forward ? x_ : y_, .w = w_, .bias = {}, .out = forward ? y_ : x_}, scratch_);
  }

 private:
  Slice place(const TensorSpec& spec) {
    Slice slice = arena_.allocate(spec.bytes());
    Recorder recorder(device_);
    // 0.01 as a float, or twice as float16.
    recorder.fill(slice, spec.storage == Storage::kFloat16 ? 0x211f211f : 0x3c23d70a);
    recorder.finish()->run();
    slice.storage = spec.storage;
    return slice;
  }

  const Device& device_;
  const TuningCase& case_;
  Arena arena_;
  Slice x_, y_, w_, scratch_;
};

}  // namespace

std::vector<TuningCase> tuning_cases(const Graph& graph, const Caps& caps) {
  std::vector<TuningCase> cases;
  std::set<std::string> keys;
  const auto add = [&](const Convolution& convolution, std::optional<ConvDirection> direction) {
    const auto& [shape, storage] = convolution;
    const ConvAlgorithm algorithm =
        direction ? choose_convolution(shape, *direction, caps) : choose_weight_gradient(shape, caps);
    if (algorithm != ConvAlgorithm::kDirect) return;
    const auto tuning = direction ? conv_product_tuning(shape, *direction, caps, storage)
                                  : weight_gradient_tuning(shape, caps, storage);
    if (tuning && !tuning->candidates.empty() && keys.insert(tuning->key).second)
      cases.push_back({shape, direction, storage, *tuning});
  };
  for (const Node& node : graph.nodes())
    if (const auto convolution = convolution_of(graph, node)) {
      add(*convolution, ConvDirection::kForward);
      add(*convolution, ConvDirection::kTransposed);
      add(*convolution, std::nullopt);
    }
  return cases;
}

size_t choose_from_timings(std::span<const double> seconds) {
  const auto counts = [](double s) { return std::isfinite(s) && s > 0; };
  size_t best = 0;
  double least = !seconds.empty() && counts(seconds[0]) ? kWorthAChange * seconds[0]
                                                        : std::numeric_limits<double>::infinity();
  for (size_t i = 1; i < seconds.size(); ++i)
    if (counts(seconds[i]) && seconds[i] < least) {
      best = i;
      least = seconds[i];
    }
  return best;
}

TunedCase tune(const TuningCase& tuned, const TileTiming& timing) {
  std::vector<double> seconds{timing(tuned, tuned.tuning.standard)};
  for (const auto& tile : tuned.tuning.candidates) seconds.push_back(timing(tuned, tile));
  const size_t best = choose_from_timings(seconds);
  return {.key = tuned.tuning.key,
          .standard = tuned.tuning.standard,
          .chosen = best == 0 ? tuned.tuning.standard : tuned.tuning.candidates[best - 1],
          .standard_seconds = seconds[0],
          .chosen_seconds = seconds[best]};
}

void remember(const TunedCase& tuned, TunedChoices& choices) {
  if (tuned.chosen == tuned.standard)
    choices.erase(tuned.key);
  else
    choices[tuned.key] = tuned.chosen;
}

DeviceTiming::DeviceTiming(DeviceOptions options, int repeats) : repeats_(repeats) {
  options.tuned = [choices = choices_](const Caps&) { return choices; };
  device_ = std::make_unique<Device>(std::move(options));
}

namespace {

/// What the device took for all commands of the last run.
double device_seconds(const Commands& commands) {
  double seconds = 0;
  for (const CommandTime& time : commands.command_times()) seconds += time.end - time.begin;
  return seconds;
}

}  // namespace

double DeviceTiming::operator()(const TuningCase& tuned, const std::vector<uint32_t>& tile) {
  *choices_ = {{tuned.tuning.key, tile}};
  const Operands operands(*device_, tuned);
  const bool timestamps = device_->caps().timestamp_period > 0;
  Recorder recorder(*device_, timestamps);
  recorder.begin_section();
  operands.record(recorder);
  recorder.end_section();
  const auto commands = recorder.finish();
  commands->run();  // warms caches and, on GPUs, clocks
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats_; ++i) {
    const auto start = std::chrono::steady_clock::now();
    commands->run();
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    least = std::min(least, timestamps ? device_seconds(*commands) : wall.count());
  }
  choices_->clear();
  return least;
}

}  // namespace vkopple
