#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/wide_vectors.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/precision_option.h"
#include "tools/set_option.h"
#include "train/benchmark.h"
#include "train/conv_benchmark.h"
#include "train/op_table.h"
#include "train/peak.h"
#include "train/tuning_file.h"

namespace vkopple {
namespace {

struct Options {
  std::string what;
  std::string preset = "full";
  std::vector<std::string> set;
  BenchmarkOptions benchmark;
  std::optional<Precision> precision;
  std::string by_op;  ///< "shape" or "op"; empty: the short table
  WinogradUse winograd = WinogradUse::kWhereFaster;
  bool json = false;
  std::string device;
  KernelFamily kernels = KernelFamily::kAuto;
};

nlohmann::ordered_json header(const Device& device, const Options& options) {
  return {{"what", options.what},
          {"preset", options.preset},
          {"set", options.set},
          {"batch", options.benchmark.batch},
          {"device", device.caps().name},
          {"driver", device.caps().driver},
          {"tuned", device.caps().tuned != nullptr}};
}

void add(nlohmann::ordered_json& out, const BenchmarkResult& r) {
  out["seconds_per_step"] = r.seconds_per_step;
  out["triplets_per_second"] = r.triplets_per_second;
  out["gflop_per_triplet"] = r.gflop_per_triplet;
  if (r.authors_gflop_per_triplet > 0) out["authors_gflop_per_triplet"] = r.authors_gflop_per_triplet;
  out["peak_device_bytes"] = r.peak_device_bytes;
  out["resident_growth_bytes"] = r.resident_growth_bytes;
  out["first_step_seconds"] = r.first_step_seconds;
  out["dispatches"] = r.dispatches;
  out["by_op"] = r.by_op;
}

/// Rows of the profile with their share of the machine's peak.
struct OpTable {
  std::vector<OpRow> rows;
  double peak_gflops = 0;
};

OpTable table_of(const Device& device, const Options& options, const BenchmarkResult& r) {
  return {op_table(r.passes, options.by_op == "op" ? OpRows::kByOp : OpRows::kByShape),
          measure_peak_gflops(device)};
}

void add(nlohmann::ordered_json& out, const OpTable& table) {
  out["peak_gflops"] = table.peak_gflops;
  for (const OpRow& row : table.rows) {
    out["ops"].push_back({{"op", row.op},
                          {"pass", row.pass},
                          {"shape", row.shape},
                          {"count", row.count},
                          {"seconds", row.seconds},
                          {"share", row.share},
                          {"gflop", row.gflop},
                          {"gbytes", row.gbytes},
                          {"gflops", row.gflops()},
                          {"peak_share", row.gflops() / table.peak_gflops}});
  }
}

void print(const OpTable& table) {
  double seconds = 0;
  for (const OpRow& row : table.rows) seconds += row.seconds;
  fmt::print("  {:.2f} ms on the device in a step of its own; peak {:.0f} GFLOP/s\n", seconds * 1e3,
             table.peak_gflops);
  fmt::print("  {:>9} {:>7} {:>6} {:>8} {:>7} {:>8}  op\n", "ms", "share", "count", "GFLOP/s", "of peak",
             "GB/s");
  for (const OpRow& row : table.rows) {
    if (row.share < 0.0005) continue;
    const std::string work =
        row.gflop > 0 ? fmt::format("{:>8.1f} {:>6.1f}%", row.gflops(), 100 * row.gflops() / table.peak_gflops)
                      : fmt::format("{:>8} {:>7}", "", "");
    fmt::print("  {:>9.2f} {:>6.1f}% {:>6} {} {:>8.1f}  {}.{} {}\n", row.seconds * 1e3, 100 * row.share,
               row.count, work, row.gbytes / row.seconds, row.op, row.pass, row.shape);
  }
}

void print_by_op(const BenchmarkResult& r) {
  std::vector<std::pair<double, std::string>> ops;
  for (const auto& [op, seconds] : r.by_op) ops.emplace_back(seconds, op);
  std::sort(ops.rbegin(), ops.rend());
  for (const auto& [seconds, op] : ops)
    if (seconds > 0.002 * r.seconds_per_step) fmt::print("  {:>9.2f} ms  {}\n", seconds * 1e3, op);
}

void print(const Device& device, const Options& options, const BenchmarkResult& r) {
  std::string preset = options.preset;
  for (const std::string& assignment : options.set) preset += " with " + assignment;
  fmt::print("{} of {}, batch {}, on {} ({}){}\n", options.what, preset, options.benchmark.batch,
             device.caps().name, device.caps().driver, device.caps().tuned ? ", tuned" : "");
  fmt::print("  {:.4f} s a step, {:.2f} {} a second; {:.1f} GFLOP each, {:.1f} GFLOP/s\n", r.seconds_per_step,
             r.triplets_per_second, options.what == "infer" ? "images" : "triplets", r.gflop_per_triplet,
             r.gflop_per_triplet * r.triplets_per_second);
  if (r.authors_gflop_per_triplet > 0)
    fmt::print("  the authors' graph computes {:.1f} GFLOP each\n", r.authors_gflop_per_triplet);
  fmt::print("  {} MiB on the device, {} dispatches; the first step took {:.1f} s\n", r.peak_device_bytes >> 20,
             r.dispatches, r.first_step_seconds);
  if (options.by_op.empty()) print_by_op(r);
}

void print(const std::vector<ConvTiming>& timings) {
  fmt::print("{:<36} {:>18} {:>18} {:>18}   GFLOP/s\n", "convolution N,Ci,H,W -> Co", "forward", "d input",
             "d weight");
  const auto text = [](const ProductTiming& t) { return fmt::format("{} {:>7.1f}", t.algorithm, t.gflops); };
  for (const ConvTiming& t : timings)
    fmt::print("{:<36} {:>18} {:>18} {:>18}\n", t.label, text(t.forward), text(t.data_gradient),
               text(t.weight_gradient));
}

void print(const StepMemory& memory) {
  constexpr size_t kRows = 30;
  fmt::print("{} MiB of parameters, their gradients and Adam's means; {} MiB of activations and gradients\n",
             memory.groups_bytes >> 20, memory.shared_bytes >> 20);
  fmt::print("of these {} MiB are in use at once, in step {}:\n", memory.peak.bytes >> 20, memory.peak.step);
  for (size_t i = 0; i < std::min(kRows, memory.peak.held.size()); ++i)
    fmt::print("{:>9.1f} MiB  {}\n", static_cast<double>(memory.peak.held[i].bytes) / (1 << 20),
               memory.peak.held[i].what);
}

nlohmann::ordered_json to_json(const StepMemory& memory) {
  nlohmann::ordered_json held = nlohmann::ordered_json::array();
  for (const MemoryUse& use : memory.peak.held) held.push_back({{"what", use.what}, {"bytes", use.bytes}});
  return {{"groups_bytes", memory.groups_bytes},
          {"shared_bytes", memory.shared_bytes},
          {"peak_bytes", memory.peak.bytes},
          {"held_at_peak", held}};
}

void run(const Options& options) {
  if (!options.benchmark.profile && (!options.by_op.empty() || !options.benchmark.trace.empty()))
    throw UsageError("--no-profile leaves nothing for --by-op and --profile to tell");
  if (options.what == "conv" && (!options.by_op.empty() || !options.benchmark.trace.empty()))
    throw UsageError("--by-op and --profile go with step and infer");
  if (options.what != "conv" && options.benchmark.batch < 1) throw UsageError("--batch must be at least 1");
  Config config = Config::load(options.preset, options.set);
  if (options.precision) config.training.precision = *options.precision;
  require_kernels_suit(options.kernels,
                       options.what == "conv" ? Precision::kFloat32 : config.training.precision);
  const bool long_work = options.what != "infer";
  if (long_work) prefer_wide_vectors();
  const Device device({.selector = options.device,
                       .long_work = long_work,
                       .winograd = options.winograd,
                       .kernels = options.kernels,
                       .tuned = load_tuned_choices});
  nlohmann::ordered_json out = header(device, options);
  if (options.what == "conv") {
    const auto timings = benchmark_convolutions(device, options.benchmark.batch, options.benchmark.repeats);
    for (const ConvTiming& t : timings)
      out["convolutions"].push_back({{"shape", t.label},
                                     {"transposed", t.shape.transposed},
                                     {"kernel", t.shape.kernel},
                                     {"stride", t.shape.stride},
                                     {"batch", t.shape.batch},
                                     {"in_channels", t.shape.in_channels},
                                     {"size", t.shape.size},
                                     {"out_channels", t.shape.out_channels},
                                     {"forward_gflops", t.forward.gflops},
                                     {"data_gradient_gflops", t.data_gradient.gflops},
                                     {"weight_gradient_gflops", t.weight_gradient.gflops},
                                     {"forward_algorithm", t.forward.algorithm},
                                     {"data_gradient_algorithm", t.data_gradient.algorithm},
                                     {"weight_gradient_algorithm", t.weight_gradient.algorithm}});
    if (!options.json) print(timings);
  } else if (options.what == "memory") {
    const StepMemory memory =
        measure_memory(device, Config::load(options.preset, options.set), options.benchmark);
    out.update(to_json(memory));
    if (!options.json) print(memory);
  } else {
    out["precision"] = kPrecisionNames[static_cast<size_t>(config.training.precision)];
    const BenchmarkResult result = options.what == "step"
                                       ? benchmark_step(device, config, options.benchmark)
                                       : benchmark_inference(device, config, options.benchmark);
    add(out, result);
    if (!options.json) print(device, options, result);
    if (!options.by_op.empty()) {
      const OpTable table = table_of(device, options, result);
      add(out, table);
      if (!options.json) print(table);
    }
  }
  if (options.json) fmt::print("{}\n", out.dump(2));
}

}  // namespace

void add_bench(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bench", "Time a training step, inference, or convolutions");
  const auto options = std::make_shared<Options>();
  command->add_option("what", options->what, "step, infer, conv, or memory: what fills it in a step")
      ->required()
      ->check(CLI::IsMember({"step", "infer", "conv", "memory"}));
  command->add_option("--preset", options->preset, "Preset or configuration file")->capture_default_str();
  add_set_option(*command, options->set);
  command->add_option("--batch", options->benchmark.batch, "Triplets a step (images for infer)")
      ->capture_default_str();
  command->add_option("--stage", options->benchmark.stage,
                      "Stage of training that step times (default: the last)");
  command->add_option("--repeats", options->benchmark.repeats, "Timed runs, of which the median counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("!--no-profile", options->benchmark.profile,
                    "Leave out the times of single ops, which take runs of their own");
  command
      ->add_flag(
          "--by-op{shape}", options->by_op,
          "Table of the step or image by op, pass and shape, sorted by time, with the share of the peak that a "
          "probe of multiply-adds finds; --by-op=op: without shapes")
      ->check(CLI::IsMember({"shape", "op"}));
  command->add_option("--profile", options->benchmark.trace,
                      "Write a trace of a step or image, for chrome://tracing or Perfetto");
  add_winograd_option(*command, options->winograd);
  command->add_flag("--json", options->json, "Print JSON");
  add_precision_option(*command, options->precision,
                       "what the configuration says, float32 where it says nothing; conv: always float32");
  add_device_option(*command, options->device);
  add_kernels_option(*command, options->kernels);
  command->footer("Example: vkopple bench step --preset small --batch 4 --json");
  command->callback([options] { run(*options); });
}

}  // namespace vkopple
