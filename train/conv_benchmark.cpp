#include "train/conv_benchmark.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <memory>

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
};

Case plain(int64_t batch, int64_t ci, int64_t size, int64_t co, int64_t kernel, int64_t stride) {
  return {fmt::format("{}x{}{}  {},{},{},{} -> {}", kernel, kernel, stride == 2 ? " stride 2" : "", batch, ci,
                      size, size, co),
          {false, kernel, stride, batch, ci, size, co},
          std::make_shared<Conv2d>(Conv2dOptions{.stride = stride, .padding = kernel / 2}, true),
          {batch, ci, size, size},
          {co, ci, kernel, kernel}};
}

Case transposed(int64_t batch, int64_t ci, int64_t size, int64_t co, int64_t kernel) {
  return {fmt::format("transposed {}x{}  {},{},{},{} -> {}", kernel, kernel, batch, ci, size, size, co),
          {true, kernel, 2, batch, ci, size, co},
          std::make_shared<ConvTranspose2d>(ConvTranspose2dOptions{}, true),
          {batch, ci, size, size},
          {ci, co, kernel, kernel}};
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
    const double flop = needs_.forward_flop * 1e-9;
    ConvTiming timing{.label = case_.name, .shape = case_.shape};
    timing.forward = flop / best([&](Recorder& r) { case_.op->record_forward(r, {x_, y_, {}, scratch_}); });
    timing.data_gradient = flop / best([&](Recorder& r) { backward(r, {true, false, false}); });
    timing.weight_gradient = flop / best([&](Recorder& r) { backward(r, {false, true, true}); });
    return timing;
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
  const std::vector<Case> cases{
      plain(batch, 64, 128, 64, 3, 1),  plain(batch, 64, 64, 64, 3, 1),   plain(batch, 128, 32, 128, 3, 1),
      plain(batch, 256, 16, 256, 3, 1), plain(batch, 256, 8, 256, 3, 1),  plain(batch, 16, 128, 16, 3, 1),
      plain(batch, 8, 128, 8, 3, 1),    plain(batch, 3, 128, 64, 3, 1),   plain(batch, 64, 128, 64, 3, 2),
      plain(batch, 640, 16, 128, 1, 1), transposed(batch, 64, 64, 64, 3), transposed(batch, 32, 64, 16, 2)};
  std::vector<ConvTiming> timings;
  for (const Case& c : cases) timings.push_back(Timing(device, c, repeats).run());
  return timings;
}

}  // namespace vkopple
