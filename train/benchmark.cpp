#include "train/benchmark.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <vector>

#include "models/authors_cost.h"
#include "models/perception.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "train/op_table.h"
#include "train/random.h"
#include "train/resident_memory.h"
#include "train/trace.h"
#include "train/training_step.h"

namespace vkopple {
namespace {

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

TrainingStage find_stage(const Config& config, const std::string& name) {
  const auto stages = config.stages();
  if (name.empty()) return stages.back();
  const auto found =
      std::find_if(stages.begin(), stages.end(), [&](const TrainingStage& s) { return s.name == name; });
  if (found == stages.end())
    throw UsageError(fmt::format("--stage {}: the configuration has no such stage", name));
  return *found;
}

std::vector<float> noise(int64_t count) {
  Random random(1, 0);
  std::vector<float> values(static_cast<size_t>(count));
  for (float& v : values) v = static_cast<float>(random.uniform());
  return values;
}

Triplets made_up(const ModelConfig& model, int64_t batch) {
  Triplets t;
  t.images = noise(3 * batch * 3 * model.height * model.width);
  for (int frame = 0; frame < 3; ++frame)
    for (int64_t b = 0; b < batch; ++b)
      t.poses.push_back({0.05 * frame, 0.02 * frame, 0.7, 0.03 * frame, 0, 0});
  for (int64_t b = 0; b < batch; ++b) t.permutation.push_back(static_cast<uint32_t>((b + 1) % batch));
  return t;
}

void initialise(Executor& executor, const std::vector<InitialTensor>& tensors) {
  for (const InitialTensor& t : tensors)
    executor.write(t.value, initial_values(t.initial, t.value.shape().elements(), 1, t.name));
}

uint64_t growth_since(const std::optional<ResidentMemory>& before) {
  const auto after = resident_memory();
  return before && after && after->peak > before->now ? after->peak - before->now : 0;
}

/// Runs `step` once for warmth and then `repeats` times, and completes the result.
void time_steps(BenchmarkResult& result, const BenchmarkOptions& options, const std::function<void()>& step) {
  step();
  std::vector<double> seconds;
  for (int i = 0; i < options.repeats; ++i) seconds.push_back(seconds_of(step));
  result.seconds_per_step = median(seconds);
  result.triplets_per_second = static_cast<double>(options.batch) / result.seconds_per_step;
}

/// Completes the result by a step that was made for profiling, `step`, run once for warmth before.
void profile_step(BenchmarkResult& result, const BenchmarkOptions& options, const Device& device,
                  const std::function<void(Trace&)>& step) {
  Trace warm_up(device.caps());
  step(warm_up);
  Trace trace(device.caps());
  {
    const Trace::Span span(&trace, "step");
    step(trace);
  }
  if (!options.trace.empty()) trace.write(options.trace);
  for (const OpRow& row : op_table(result.passes, OpRows::kByOp))
    result.by_op[row.op + "." + row.pass] = row.seconds;
}

}  // namespace

StepMemory measure_memory(const Device& device, const Config& config, const BenchmarkOptions& options) {
  TrainingStage stage = find_stage(config, options.stage);
  stage.batch = static_cast<int>(options.batch);
  TrainingStep training(device, config, stage, nullptr);
  const Executor& executor = training.executor();
  return {.groups_bytes = executor.total_bytes() - executor.shared_bytes(),
          .shared_bytes = executor.shared_bytes(),
          .peak = executor.memory_peak()};
}

BenchmarkResult benchmark_step(const Device& device, const Config& config, const BenchmarkOptions& options) {
  TrainingStage stage = find_stage(config, options.stage);
  stage.batch = static_cast<int>(options.batch);
  const Triplets triplets = made_up(config.model, portion_batch(stage, nullptr));
  BenchmarkResult result;
  const auto memory_before = resident_memory();
  std::unique_ptr<TrainingStep> training;
  uint32_t step = 0;
  const auto portion = [&](int) { return triplets; };
  const auto run = [&] { training->run(portion, 1, step++); };
  const auto build = [&](bool profile) {
    training = std::make_unique<TrainingStep>(device, config, stage, nullptr, profile);
    initialise(training->executor(), training->model().tensors());
  };
  result.first_step_seconds = seconds_of([&] {
    build(false);
    run();
  });
  time_steps(result, options, run);
  const Executor& executor = training->executor();
  result.gflop_per_triplet =
      (executor.forward_flop() + executor.backward_flop()) * 1e-9 / static_cast<double>(training->batch());
  if (!training->model().options().background_only)
    result.authors_gflop_per_triplet = authors_flop(config.model) * 1e-9;
  result.peak_device_bytes = executor.total_bytes();
  result.dispatches = executor.dispatches();
  result.resident_growth_bytes = growth_since(memory_before);
  if (!options.profile) return result;
  training.reset();  // two models at once may not fit
  build(true);       // timestamps cost a little: they get runs of their own
  profile_step(result, options, device, [&](Trace& trace) {
    training->run(portion, 1, step++, &trace);
    result.passes = training->executor().passes();
  });
  return result;
}

BenchmarkResult benchmark_inference(const Device& device, const Config& config,
                                    const BenchmarkOptions& options) {
  const auto images = noise(options.batch * 3 * config.model.height * config.model.width);
  BenchmarkResult result;
  const auto memory_before = resident_memory();
  std::unique_ptr<Perception> perception;
  const auto run = [&] { perception->see(images); };
  const auto build = [&](bool profile) {
    perception = std::make_unique<Perception>(
        device, config.model, std::make_shared<GroupStore>(device),
        PerceptionOptions{.batch = options.batch, .profile = profile, .precision = config.training.precision});
    initialise(perception->executor(), perception->tensors());
  };
  result.first_step_seconds = seconds_of([&] {
    build(false);
    run();
  });
  time_steps(result, options, run);
  Executor& executor = perception->executor();
  result.gflop_per_triplet = executor.forward_flop() * 1e-9 / static_cast<double>(options.batch);
  result.peak_device_bytes = executor.total_bytes();
  result.dispatches = executor.dispatches();
  result.resident_growth_bytes = growth_since(memory_before);
  if (!options.profile) return result;
  perception.reset();
  build(true);
  profile_step(result, options, device, [&](Trace& trace) {
    run();
    result.passes = perception->executor().passes();
    for (const PassProfile& pass : result.passes) trace.add_pass(pass);
  });
  return result;
}

}  // namespace vkopple
