#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "models/config.h"
#include "models/opple.h"
#include "runtime/error.h"
#include "runtime/wide_vectors.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/precision_option.h"
#include "tools/set_option.h"
#include "train/count_progress.h"
#include "train/interrupt.h"
#include "train/tuner.h"
#include "train/tuning_file.h"

namespace vkopple {
namespace {

struct Options {
  std::string preset = "full";
  std::vector<std::string> set;
  std::optional<int> batch;
  std::optional<Precision> precision;
  int repeats = 5;
  bool json = false;
  std::string device;
  KernelFamily kernels = KernelFamily::kAuto;
};

std::vector<TuningCase> cases_of(const Config& config, const Options& o, const Caps& caps) {
  Graph graph;
  const Opple model(graph, config.model,
                    {.batch = o.batch.value_or(config.stages().back().batch),
                     .training = true,
                     .precision = o.precision.value_or(config.training.precision),
                     .max_tensor_bytes = caps.max_tensor_bytes()});
  return tuning_cases(graph, caps);
}

nlohmann::ordered_json to_json(const TunedCase& t) {
  return {{"product", t.key},
          {"default_tile", t.standard},
          {"chosen_tile", t.chosen},
          {"default_seconds", t.standard_seconds},
          {"chosen_seconds", t.chosen_seconds},
          {"speed_up", t.standard_seconds / t.chosen_seconds}};
}

void print(const std::vector<TunedCase>& all) {
  fmt::print("{:<108} {:>12} {:>12} {:>8}\n", "product", "default", "chosen", "speed-up");
  double before = 0;
  double after = 0;
  for (const TunedCase& t : all) {
    fmt::print("{:<108} {:>12} {:>12} {:>7.2f}x\n", t.key, fmt::format("{}", fmt::join(t.standard, " ")),
               t.chosen == t.standard ? "" : fmt::format("{}", fmt::join(t.chosen, " ")),
               t.standard_seconds / t.chosen_seconds);
    before += t.standard_seconds;
    after += t.chosen_seconds;
  }
  if (after > 0) fmt::print("all of them once: {:.1f} ms, tuned {:.1f} ms\n", before * 1e3, after * 1e3);
}

void run(const Options& o) {
  const Config config = Config::load(o.preset, o.set);
  require_kernels_suit(o.kernels, Precision::kFloat32);
  prefer_wide_vectors();  // as train does
  DeviceTiming timing({.selector = o.device, .long_work = true, .kernels = o.kernels}, o.repeats);
  const Caps& caps = timing.device().caps();
  const auto file = tuning_file(caps);
  if (file.empty()) throw Error("no cache folder is known for what tuning finds; set XDG_CACHE_HOME or HOME");
  const auto cases = cases_of(config, o, caps);
  if (cases.empty()) throw Error(fmt::format("{}: its kernels have no tiles to choose", caps.name));
  const auto known = load_tuned_choices(caps);
  TunedChoices choices = known ? *known : TunedChoices{};
  std::vector<TunedCase> all;
  const Interrupt interrupt;
  {
    CountProgress progress("products", cases.size());
    for (const TuningCase& tuned : cases) {
      if (interrupt.requested()) break;
      all.push_back(tune(tuned, std::ref(timing)));
      remember(all.back(), choices);
      progress.show(all.size());
    }
  }
  save_tuned_choices(file, caps, choices);
  if (o.json) {
    nlohmann::ordered_json out{{"device", caps.name}, {"driver", caps.driver}, {"file", file.string()}};
    out["products"] = nlohmann::ordered_json::array();
    for (const TunedCase& t : all) out["products"].push_back(to_json(t));
    fmt::print("{}\n", out.dump(2));
  } else {
    print(all);
    fmt::print("kept in {}\n", file.string());
  }
  if (all.size() < cases.size())
    throw Error(
        fmt::format("stopped after {} of {} products; what was found is kept", all.size(), cases.size()));
}

}  // namespace

void add_tune(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "tune", "Measure the kernels' tiles on this device, for later runs of train, bench and infer");
  const auto o = std::make_shared<Options>();
  command->add_option("--preset", o->preset, "Preset or configuration file")->capture_default_str();
  command->add_option("--batch", o->batch, "Triplets of a step (default: the last stage's)")
      ->check(CLI::Range(1, 4096));
  command->add_option("--repeats", o->repeats, "Timed runs of a tile, of which the best counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--json", o->json, "Print JSON");
  add_set_option(*command, o->set);
  add_precision_option(*command, o->precision, "what the configuration says, float32 where it says nothing");
  add_device_option(*command, o->device);
  add_kernels_option(*command, o->kernels);
  command->footer("Example: vkopple tune --preset small --batch 16");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
