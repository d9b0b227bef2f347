#include "graph/checks/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include "graph/float16.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/guarded_memory.h"
#include "runtime/transfer.h"

namespace vkopple {
namespace {

/// Most elements of one input whose derivative is taken numerically; larger tensors are sampled.
constexpr size_t kMostProbes = 240;
constexpr double kStep = 1e-5;
const float kNaN = std::bit_cast<float>(kNaNWord);

std::vector<float> as_words(const TensorSpec& spec, const HostTensor& tensor) {
  std::vector<float> words(tensor.values.size());
  for (size_t i = 0; i < words.size(); ++i)
    words[i] = spec.dtype == DType::kU32 ? std::bit_cast<float>(static_cast<uint32_t>(tensor.values[i]))
                                         : static_cast<float>(tensor.values[i]);
  return to_layout(spec, words);
}

HostTensor from_words(const TensorSpec& spec, const std::vector<float>& stored) {
  HostTensor tensor(spec.shape);
  const auto values = from_layout(spec, stored);
  for (size_t i = 0; i < values.size(); ++i)
    tensor.values[i] = spec.dtype == DType::kU32 ? static_cast<double>(std::bit_cast<uint32_t>(values[i]))
                                                 : static_cast<double>(values[i]);
  return tensor;
}

/// Uniform in [low, high), the same on every machine.
double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

/// Compares so that a NaN on either side gives a NaN, which no limit lets pass. Relative to `part` where that
/// is larger: of a sum that nearly cancels.
Deviation compare(const std::vector<double>& got, const std::vector<double>& want,
                  const std::vector<double>& part) {
  double worst = 0;
  double largest = 0;
  double difference2 = 0;
  double want2 = 0;
  for (size_t i = 0; i < want.size(); ++i) {
    const double d = std::abs(got[i] - want[i]);
    if (!(d <= worst)) worst = std::isnan(worst) ? worst : d;
    largest = std::max(largest, std::abs(want[i]));
    difference2 += d * d;
    want2 += want[i] * want[i];
  }
  double part2 = 0;
  for (const double p : part) {
    largest = std::max(largest, std::abs(p));
    part2 += p * p;
  }
  want2 = std::max(want2, part2);
  // A reference that is zero throughout leaves the absolute error as the measure.
  const double scale = largest > 1e-9 ? largest : 1.0;
  const double norm = want2 > 1e-18 ? std::sqrt(want2) : 1.0;
  return {worst / scale, std::sqrt(difference2) / norm};
}

class Bench {
 public:
  Bench(const Device& device, const CheckCase& check, Storage activations)
      : device_(device), check_(check), op_(*check.op), activations_(activations), memory_(device) {
    for (const TensorSpec& spec : check.inputs) inputs_.push_back(stored_as(spec, activations));
    result_.op = op_.name();
    result_.label = check.label;
  }

  CheckResult run() {
    draw_inputs();
    specs_ = infer_stored(op_, inputs_, activations_);
    needs_ = op_.needs(check_.inputs, device_.caps());
    run_forward();
    const bool any = std::any_of(wanted_.begin(), wanted_.end(), [](bool w) { return w; });
    if (any) run_backward();
    return std::move(result_);
  }

 private:
  void draw_inputs() {
    std::mt19937 random(1234);
    for (size_t i = 0; i < check_.inputs.size(); ++i) {
      HostTensor tensor(inputs_[i].shape);
      const auto range = i < check_.ranges.size() ? check_.ranges[i] : std::pair(-1.0, 1.0);
      for (double& v : tensor.values) v = uniform(random, range.first, range.second);
      x_.push_back(std::move(tensor));
      wanted_.push_back(op_.differentiable(i) && inputs_[i].dtype == DType::kF32);
    }
    if (check_.prepare) check_.prepare(x_);
    for (size_t i = 0; i < x_.size(); ++i) round(inputs_[i], x_[i]);
  }

  /// To what the tensor can hold.
  static void round(const TensorSpec& spec, HostTensor& tensor) {
    for (double& v : tensor.values) {
      const auto single = static_cast<float>(v);
      v = static_cast<double>(spec.storage == Storage::kFloat16 ? float16_value(float16_bits(single)) : single);
    }
  }

  Operand place(const TensorSpec& spec, const std::string& what) {
    Operand operand{spec, memory_.allocate(spec.bytes(), what)};
    operand.slice.storage = spec.storage;
    return operand;
  }
  void write(const Operand& operand, const std::vector<float>& words) {
    upload_values<float>(device_, operand.slice, words);
  }
  std::vector<float> read(const Operand& operand) { return download_values<float>(device_, operand.slice); }
  Slice scratch(uint64_t bytes) {
    if (bytes == 0) return {};
    return memory_.allocate((bytes + 3) / 4 * 4, "scratch");
  }
  /// Runs what was recorded and has a look at the guards.
  void run(Recorder& recorder, const char* pass) {
    recorder.finish()->run();
    for (const std::string& damage : memory_.damage())
      fail(fmt::format("[{}] wrote outside of its operands in {}: {}", op_.name(), pass, damage));
  }

  static int roundings_of(const TensorSpec& spec) { return spec.storage == Storage::kFloat16 ? 1 : 0; }
  /// Whether backward reads outputs that forward rounded.
  int output_roundings() const {
    for (size_t i = 0; i < specs_.size() && i < 32; ++i)
      if (specs_[i].storage == Storage::kFloat16 && (needs_.outputs_for_backward >> i & 1) != 0) return 1;
    return 0;
  }

  void fail(const std::string& message) { result_.failures.push_back(message); }

  /// roundings: how often float16 has rounded what is judged, or `part` of it where that is given. Once where
  /// it is stored so; gradients may read outputs that forward rounded; an accumulated gradient is rounded as
  /// what it is compared with and as the sum. Each adds at most the unit round-off to a tensor's error, in both
  /// measures.
  void judge(Deviation& total, const std::string& what, const std::vector<double>& got,
             const std::vector<double>& want, int roundings, const std::vector<double>& part = {}) {
    const Deviation d = compare(got, want, part);
    const double rounded = kFloat16Roundoff * roundings;
    if (!(d.worst <= kWorstLimit + rounded && d.l2 <= kL2Limit + rounded)) {
      size_t at = 0;
      const auto difference = [&](size_t i) { return std::abs(got[i] - want[i]); };
      for (size_t i = 0; i < want.size() && !std::isnan(difference(at)); ++i)
        if (!(difference(i) <= difference(at))) at = i;
      fail(fmt::format("{}: worst {:.2e}, L2 {:.2e}; element {} is {:.8g} and should be {:.8g}", what, d.worst,
                       d.l2, at, got[at], want[at]));
    }
    if (!(d.worst <= total.worst)) total.worst = d.worst;
    if (!(d.l2 <= total.l2)) total.l2 = d.l2;
  }

  void require_zero_padding(const std::string& what, const Operand& operand) {
    if (operand.spec.layout != Layout::kChannels4) return;
    const auto words = read(operand);
    const TensorSpec plain = stored_as(operand.spec, Storage::kFloat32);
    const auto stored = operand.spec.storage == Storage::kFloat16 ? from_float16(words) : words;
    const auto again = to_layout(plain, from_layout(plain, stored));
    for (size_t i = 0; i < stored.size(); ++i)
      if (!(stored[i] == again[i]) && again[i] == 0.0F) {
        fail(fmt::format("{}: padding lane at element {} holds {}, not zero", what, i,
                         static_cast<double>(stored[i])));
        return;
      }
  }

  void run_forward() {
    for (size_t i = 0; i < x_.size(); ++i) input_.push_back(place(inputs_[i], fmt::format("input {}", i)));
    for (size_t i = 0; i < specs_.size(); ++i) output_.push_back(place(specs_[i], fmt::format("output {}", i)));
    const HostTensors want = check_.reference(x_);
    if (!needs_.saved.empty()) {
      std::vector<Operand> unsaved;
      for (const TensorSpec& spec : needs_.saved) unsaved.push_back({spec, {}});
      record_forward(unsaved);
      judge_forward("inference: ", want);
    }
    for (size_t i = 0; i < needs_.saved.size(); ++i)
      saved_.push_back(place(needs_.saved[i], fmt::format("saved tensor {}", i)));
    record_forward(saved_);
    judge_forward("", want);
  }

  void record_forward(const std::vector<Operand>& saved) {
    for (size_t i = 0; i < x_.size(); ++i) write(input_[i], as_words(inputs_[i], x_[i]));
    for (const Operand& y : output_) write(y, std::vector<float>(y.spec.bytes() / 4, kNaN));
    Recorder recorder(device_, false, Bounds::kGuarded);
    op_.record_forward(recorder, {input_, output_, saved, scratch(needs_.forward_scratch)});
    run(recorder, "forward");
  }

  void judge_forward(const std::string& mode, const HostTensors& want) {
    size_t next = 0;
    for (const Operand& y : output_) {
      const std::string what = fmt::format("{}output {}", mode, next);
      judge(result_.forward, what, from_words(y.spec, read(y)).values, want.at(next).values,
            roundings_of(y.spec));
      require_zero_padding(what, y);
      ++next;
    }
    for (size_t i = 0; i < x_.size(); ++i)
      if (op_.mutates(i))
        judge(result_.forward, fmt::format("{}updated input {}", mode, i),
              from_words(input_[i].spec, read(input_[i])).values, want.at(next++).values,
              roundings_of(input_[i].spec));
  }

  /// The scalar sum of r · y whose gradient is checked; r is fixed.
  double objective(const HostTensors& x) const {
    const HostTensors y = check_.reference(x);
    double sum = 0;
    for (size_t o = 0; o < cotangent_.size(); ++o)
      for (size_t i = 0; i < cotangent_[o].values.size(); ++i) sum += cotangent_[o].values[i] * y[o].values[i];
    return sum;
  }

  std::vector<size_t> probes(size_t elements) const {
    std::vector<size_t> chosen;
    if (elements <= kMostProbes) {
      for (size_t i = 0; i < elements; ++i) chosen.push_back(i);
    } else {
      std::mt19937 random(99);
      for (size_t i = 0; i < kMostProbes; ++i) chosen.push_back(random() % elements);
    }
    return chosen;
  }

  std::vector<Operand> record_backward(const std::vector<Operand>& dx, uint8_t accumulate) {
    const std::vector<uint8_t> flags(dx.size(), accumulate);
    Recorder recorder(device_, false, Bounds::kGuarded);
    op_.record_backward(recorder, {input_, output_, saved_, dy_, dx, flags, scratch(needs_.backward_scratch)});
    run(recorder, "backward");
    return dx;
  }

  void poison_unneeded() {
    const auto poison = [&](const std::vector<Operand>& operands, uint32_t mask) {
      for (size_t i = 0; i < operands.size() && i < 32; ++i)
        if ((mask >> i & 1) == 0) write(operands[i], std::vector<float>(operands[i].spec.bytes() / 4, kNaN));
    };
    poison(input_, needs_.inputs_for_backward);
    poison(output_, needs_.outputs_for_backward);
  }

  void run_backward() {
    std::mt19937 random(77);
    for (size_t i = 0; i < output_.size(); ++i) {
      const Operand& y = output_[i];
      HostTensor r(y.spec.shape);
      for (double& v : r.values) v = uniform(random, -1, 1);
      round(y.spec, r);
      dy_.push_back(place(y.spec, fmt::format("output {}'s gradient", i)));
      write(dy_.back(), as_words(y.spec, r));
      cotangent_.push_back(std::move(r));
    }
    poison_unneeded();
    std::vector<Operand> dx;
    for (size_t i = 0; i < x_.size(); ++i)
      dx.push_back(wanted_[i] ? place(inputs_[i], fmt::format("gradient {}", i)) : Operand{inputs_[i], {}});
    record_backward(dx, 0);
    std::vector<HostTensor> first;
    for (size_t i = 0; i < x_.size(); ++i) {
      first.push_back(wanted_[i] ? from_words(dx[i].spec, read(dx[i])) : HostTensor());
      if (!wanted_[i]) continue;
      check_gradient(i, first[i]);
      require_zero_padding(fmt::format("gradient {}", i), dx[i]);
    }
    check_accumulation(dx, first);
  }

  void check_gradient(size_t input, const HostTensor& got) {
    HostTensors x = x_;
    std::vector<double> want;
    std::vector<double> have;
    for (size_t at : probes(got.values.size())) {
      const double centre = x[input].values[at];
      x[input].values[at] = centre + kStep;
      const double up = objective(x);
      x[input].values[at] = centre - kStep;
      const double down = objective(x);
      x[input].values[at] = centre;
      want.push_back((up - down) / (2 * kStep));
      have.push_back(got.values[at]);
    }
    judge(result_.backward, fmt::format("gradient {}", input), have, want,
          roundings_of(inputs_[input]) + output_roundings());
  }

  void check_accumulation(const std::vector<Operand>& dx, const std::vector<HostTensor>& first) {
    std::mt19937 random(55);
    std::vector<HostTensor> before;
    for (size_t i = 0; i < dx.size(); ++i) {
      before.emplace_back();
      if (!wanted_[i]) continue;
      before[i] = HostTensor(dx[i].spec.shape);
      for (double& v : before[i].values) v = uniform(random, -1, 1);
      round(dx[i].spec, before[i]);
      write(dx[i], as_words(dx[i].spec, before[i]));
    }
    record_backward(dx, 1);
    for (size_t i = 0; i < dx.size(); ++i) {
      if (!wanted_[i]) continue;
      for (size_t k = 0; k < before[i].values.size(); ++k) before[i].values[k] += first[i].values[k];
      const int rounded = roundings_of(dx[i].spec);
      judge(result_.backward, fmt::format("accumulated gradient {}", i),
            from_words(dx[i].spec, read(dx[i])).values, before[i].values, 2 * rounded,
            rounded != 0 ? first[i].values : std::vector<double>{});
    }
  }

  const Device& device_;
  const CheckCase& check_;
  const Op& op_;
  Storage activations_;
  std::vector<TensorSpec> inputs_;
  GuardedMemory memory_;
  CheckResult result_;
  HostTensors x_;
  std::vector<bool> wanted_;
  std::vector<TensorSpec> specs_;
  Needs needs_;
  std::vector<Operand> input_;
  std::vector<Operand> output_;
  std::vector<Operand> saved_;
  std::vector<Operand> dy_;
  HostTensors cotangent_;
};

}  // namespace

bool has_activations(const CheckCase& check) {
  const auto is_activation = [](const TensorSpec& spec) {
    return stored_as(spec, Storage::kFloat16).storage == Storage::kFloat16;
  };
  const auto outputs = check.op->infer(check.inputs);
  return std::any_of(check.inputs.begin(), check.inputs.end(), is_activation) ||
         std::any_of(outputs.begin(), outputs.end(), is_activation);
}

CheckResult run_check(const Device& device, const CheckCase& check, Storage activations) {
  CheckResult failed{
      .op = std::string(check.op->name()), .label = check.label, .forward = {}, .backward = {}, .failures = {}};
  try {
    return Bench(device, check, activations).run();
  } catch (const std::exception& error) {
    failed.failures.emplace_back(error.what());
    return failed;
  }
}

}  // namespace vkopple
