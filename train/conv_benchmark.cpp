#include "train/conv_benchmark.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "graph/conv/convolution.h"
#include "graph/ops/conv2d.h"
#include "graph/ops/conv_transpose2d.h"
#include "runtime/device.h"

namespace vkopple {
namespace {

struct Case {
  std::string name;
  TimedConvolution shape;
  std::shared_ptr<const Op> op;
  Shape x;
  Shape w;
  std::optional<ConvShape> convolution;  ///< where algorithms can be chosen
};

Case plain_case(const TimedConvolution& s) {
  const auto op = std::make_shared<Conv2d>(Conv2dOptions{.stride = s.stride, .padding = s.kernel / 2}, true);
  const Shape x{s.batch, s.in_channels, s.size, s.size};
  const Shape w{s.out_channels, s.in_channels, s.kernel, s.kernel};
  return {fmt::format("{}x{}{}  {},{},{},{} -> {}", s.kernel, s.kernel, s.stride == 2 ? " stride 2" : "",
                      s.batch, s.in_channels, s.size, s.size, s.out_channels),
          s,
          op,
          x,
          w,
          op->shape_of(x, w)};
}

Case transposed_case(const TimedConvolution& s) {
  return {fmt::format("transposed {}x{}  {},{},{},{} -> {}", s.kernel, s.kernel, s.batch, s.in_channels, s.size,
                      s.size, s.out_channels),
          s,
          std::make_shared<ConvTranspose2d>(ConvTranspose2dOptions{}, true),
          {s.batch, s.in_channels, s.size, s.size},
          {s.in_channels, s.out_channels, s.kernel, s.kernel},
          std::nullopt};
}

/// Operands of a case on the device, and the time of what is recorded on them.
class Timing {
 public:
  Timing(const Device& device, const Case& c, int repeats)
      : device_(device), case_(c), repeats_(repeats), arena_(device, MemoryKind::kDevice, "benchmark") {
    const bool is_transposed = c.op->name() == "conv_transpose2d";
    specs_ = {channels4(c.x), row_major(c.w), row_major({c.w[is_transposed ? 1 : 0]})};
    y_spec_ = c.op->infer(specs_).at(0);
    needs_ = c.op->needs(specs_, device.caps());
    for (const auto& spec : specs_) x_.push_back(place(spec));
    for (const auto& spec : specs_) dx_.push_back(place(spec));
    y_ = {place(y_spec_)};
    dy_ = {place(y_spec_)};
    const uint64_t scratch = std::max(needs_.forward_scratch, needs_.backward_scratch);
    if (scratch > 0) scratch_ = arena_.allocate(scratch);
  }

  ConvTiming run() {
    const double forward = gflops([&](Recorder& r) { case_.op->record_forward(r, {x_, y_, {}, scratch_}); });
    const double data_gradient = gflops([&](Recorder& r) { backward(r, {true, false, false}); });
    const double weight_gradient = gflops([&](Recorder& r) { backward(r, {false, true, true}); });
    return {.label = case_.name,
            .shape = case_.shape,
            .forward = {forward, product_algorithm(ConvDirection::kForward)},
            .data_gradient = {data_gradient, product_algorithm(ConvDirection::kTransposed)},
            .weight_gradient = {weight_gradient, weight_gradient_algorithm()}};
  }

 private:
  Operand place(const TensorSpec& spec) {
    const Operand operand{spec, arena_.allocate(spec.bytes())};
    Recorder recorder(device_);
    recorder.fill(operand.slice, 0x3c23d70a);  // 0.01F
    recorder.finish()->run();
    return operand;
  }

  void backward(Recorder& recorder, std::array<bool, 3> wanted) {
    std::vector<Operand> dx = dx_;
    for (size_t i = 0; i < dx.size(); ++i)
      if (!wanted[i]) dx[i].slice = {};
    const std::array<uint8_t, 3> accumulate{};
    case_.op->record_backward(recorder, {x_, y_, {}, dy_, dx, accumulate, scratch_});
  }

  std::string product_algorithm(ConvDirection direction) const {
    const auto& shape = case_.convolution;
    return std::string(
        name_of(shape ? choose_convolution(*shape, direction, device_.caps()) : ConvAlgorithm::kDirect));
  }
  std::string weight_gradient_algorithm() const {
    const auto& shape = case_.convolution;
    return std::string(
        name_of(shape ? choose_weight_gradient(*shape, device_.caps()) : ConvAlgorithm::kDirect));
  }

  double gflops(const std::function<void(Recorder&)>& record) {
    return needs_.forward_flop * 1e-9 / best(record);
  }

  double best(const std::function<void(Recorder&)>& record) {
    Recorder recorder(device_);
    record(recorder);
    const auto commands = recorder.finish();
    commands->run();
    double least = 1e30;
    for (int i = 0; i < repeats_; ++i) {
      const auto start = std::chrono::steady_clock::now();
      commands->run();
      least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return least;
  }

  const Device& device_;
  const Case& case_;
  int repeats_;
  Arena arena_;
  std::vector<TensorSpec> specs_;
  TensorSpec y_spec_;
  Needs needs_;
  std::vector<Operand> x_, dx_, y_, dy_;
  Slice scratch_;
};

}  // namespace

std::vector<ConvTiming> benchmark_convolutions(const Device& device, int64_t batch, int repeats) {
  const auto plain = [&](int64_t ci, int64_t size, int64_t co, int64_t taps, int64_t stride) {
    return TimedConvolution{false, taps, stride, batch, ci, size, co};
  };
  const auto transposed = [&](int64_t ci, int64_t size, int64_t co, int64_t taps) {
    return TimedConvolution{true, taps, 2, batch, ci, size, co};
  };
  std::vector<ConvTiming> timings;
  for (const TimedConvolution& shape :
       {plain(64, 128, 64, 3, 1), plain(64, 64, 64, 3, 1), plain(128, 32, 128, 3, 1), plain(256, 16, 256, 3, 1),
        plain(256, 8, 256, 3, 1), plain(32, 128, 32, 3, 1), plain(16, 128, 16, 3, 1), plain(8, 128, 8, 3, 1),
        plain(3, 128, 64, 3, 1), plain(64, 128, 64, 3, 2), plain(640, 16, 128, 1, 1), transposed(64, 64, 64, 3),
        transposed(32, 64, 16, 2)}) {
    const Case c = shape.transposed ? transposed_case(shape) : plain_case(shape);
    timings.push_back(Timing(device, c, repeats).run());
  }
  return timings;
}

}  // namespace vkopple
