#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <optional>
#include <string>

#include "models/config.h"
#include "models/presets.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/memory_budget.h"
#include "runtime/wide_vectors.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/precision_option.h"
#include "tools/set_option.h"
#include "tools/train_output.h"
#include "train/checkpoint.h"
#include "train/interrupt.h"
#include "train/parallel/join.h"
#include "train/parallel/memory_share.h"
#include "train/parallel/own_device.h"
#include "train/resume_point.h"
#include "train/run_folder.h"
#include "train/trainer.h"
#include "train/training_memory.h"
#include "train/tuning_file.h"

namespace vkopple {
namespace {

constexpr const char* kFitBatch = "auto";

struct Options {
  std::string config;
  std::vector<std::string> set;
  std::string data;
  std::string out;
  std::string weights;
  std::string device;
  KernelFamily kernels = KernelFamily::kAuto;
  std::optional<uint64_t> steps;
  std::optional<uint64_t> seed;
  std::optional<int> batch;
  bool fit_batch = false;  ///< --batch auto
  std::optional<int> accumulate;
  std::optional<Precision> precision;
  uint64_t checkpoint_every = TrainerOptions{RunFolder("")}.checkpoint_every;
  uint64_t keep = TrainerOptions{RunFolder("")}.keep;
  uint64_t eval_every = TrainerOptions{RunFolder("")}.eval_every;
  uint64_t max_bad_steps = TrainerOptions{RunFolder("")}.max_bad_steps;
  std::string profile;
  int profiled_steps = TrainerOptions{RunFolder("")}.profiled_steps;
  int data_threads = TrainerOptions{RunFolder("")}.data_threads;
  bool resume = false;
  TrainOutput::Choice output;
  bool sync_batch_norm = false;
  WinogradUse winograd = WinogradUse::kWhereFaster;
};

/// The command line goes before the configuration.
void set_choices(Config& config, const Options& o) {
  if (o.precision) config.training.precision = *o.precision;
  if (o.sync_batch_norm) config.training.sync_batch_norm = true;
  if (o.batch) {
    config.training.batch = *o.batch;
    for (TrainingStage& stage : config.training.stages) stage.batch = *o.batch;
  }
  if (o.accumulate) {
    config.training.accumulate = *o.accumulate;
    for (TrainingStage& stage : config.training.stages) stage.accumulate = *o.accumulate;
  }
}

/// What the command line and, where a run is resumed, its checkpoint ask for.
struct Request {
  Config config;
  TrainerOptions trainer;
};

Request new_run(const Options& o, TrainerOptions trainer) {
  if (trainer.folder.holds_checkpoint())
    throw UsageError(
        fmt::format("{}: holds a run already; go on with it by --resume, or name another --out", o.out));
  if (o.fit_batch && o.accumulate)
    throw UsageError("--batch auto: finds --accumulate by itself; leave out one of the two");
  if (o.config.empty()) throw UsageError("train: name a configuration file or a preset");
  if (o.data.empty()) throw UsageError("train: say what to train on: --data rooms:SEED, or a folder of shards");
  trainer.data = o.data;
  trainer.seed = o.seed.value_or(0);
  trainer.weights = o.weights;
  Request request{Config::load(o.config, o.set), std::move(trainer)};
  set_choices(request.config, o);
  return request;
}

Request resumed_run(const Options& o, TrainerOptions trainer) {
  if (!o.weights.empty())
    throw UsageError("--weights: a run that is resumed has its own; leave out one of --weights and --resume");
  trainer.checkpoint = find_resume_point(trainer.folder);
  const CheckpointHeader header = read_checkpoint_header(trainer.checkpoint);
  if (o.seed && *o.seed != header.position.seed)
    throw UsageError(
        fmt::format("--seed: the run has seed {}; leave it out or give the same", header.position.seed));
  trainer.seed = header.position.seed;
  trainer.data = o.data.empty() ? header.position.data : o.data;
  if (trainer.data != header.position.data)
    spdlog::warn("the run was trained on {} and goes on with {}", header.position.data, trainer.data);
  Request request{
      o.config.empty() ? Config::parse(header.config.to_json(), o.out, o.set) : Config::load(o.config, o.set),
      std::move(trainer)};
  set_choices(request.config, o);
  return request;
}

/// Trains and tells what became of the run, after `notes`.
void run_to_end(const Options& o, const Interrupt& interrupt, Trainer& trainer, bool leads,
                const std::vector<std::string>& notes) {
  TrainOutput output(o.output, trainer.plan().steps());
  if (leads)
    for (const std::string& note : notes) output.say(note);
  const std::string latest = RunFolder(o.out).latest().string();
  const uint64_t begin = trainer.position().step;
  const auto end = [&](const char* outcome, const std::string& error = {}) {
    if (!leads) return;
    nlohmann::ordered_json json{
        {"outcome", outcome}, {"step", trainer.position().step}, {"steps", trainer.plan().steps()}};
    if (error.empty())
      json["checkpoint"] = latest;
    else
      json["error"] = error;
    output.end(json);
  };
  bool complete = false;
  try {
    complete = trainer.run(output, [&] { return interrupt.requested() || !output.fault().empty(); });
  } catch (const std::exception& error) {
    end("failed", error.what());
    throw;
  }
  if (!leads) return;
  const uint64_t step = trainer.position().step;
  end(complete ? "complete" : "stopped");
  if (!output.fault().empty())
    throw Error(
        fmt::format("standard output cannot be written: {}; saved after step {} in {}, go on with --resume",
                    output.fault(), step, latest));
  if (!complete)
    output.say(
        fmt::format("stopped after {} of {} steps, saved in {}; go on with the same command and --resume", step,
                    trainer.plan().steps(), latest));
  else if (step == begin)
    output.say(fmt::format("{} has its {} steps already; give more with --steps", o.out, step));
  else
    output.say(fmt::format("done after step {}, saved in {}", step, latest));
}

/// `peers` may be null.
void train(const Options& o, const Interrupt& interrupt, JoinedPeers* peers) {
  TrainerOptions trainer_options{.folder = RunFolder(o.out)};
  trainer_options.steps = o.steps;
  trainer_options.checkpoint_every = o.checkpoint_every;
  trainer_options.keep = o.keep;
  trainer_options.eval_every = o.eval_every;
  trainer_options.max_bad_steps = o.max_bad_steps;
  trainer_options.profile = o.profile;
  trainer_options.profiled_steps = o.profiled_steps;
  trainer_options.data_threads = o.data_threads;
  trainer_options.peers = peers;
  Request request = o.resume ? resumed_run(o, trainer_options) : new_run(o, trainer_options);
  require_kernels_suit(o.kernels, request.config.training.precision);
  prefer_wide_vectors();
  const Device device({.selector = peers == nullptr ? o.device : own_device(o.device, peers->rank_on_machine()),
                       .long_work = true,
                       .winograd = o.winograd,
                       .kernels = o.kernels,
                       .tuned = load_tuned_choices});
  std::vector<std::string> notes;
  // A run that is resumed keeps the portions that were found at its beginning.
  if (o.fit_batch && !o.resume)
    notes = fit_memory(device.caps(), request.config, training_setting(request.trainer),
                       memory_share(free_memory(device), device.caps(), peers));
  Trainer trainer(device, std::move(request.config), std::move(request.trainer), o.resume);
  run_to_end(o, interrupt, trainer, peers == nullptr || peers->rank() == 0, notes);
}

/// Where one of several processes fails, the others would wait for it for ever.
void run(const Options& o) {
  const Interrupt interrupt;
  const std::unique_ptr<JoinedPeers> peers = join_peers([&] { return interrupt.requested(); });
  if (!peers) return train(o, interrupt, nullptr);
  try {
    train(o, interrupt, peers.get());
  } catch (const UsageError& error) {
    peers->abandon(error.what(), 2);
  } catch (const std::exception& error) {
    peers->abandon(error.what(), 1);
  }
}

}  // namespace

void add_train(CLI::App& app) {
  CLI::App* command = app.add_subcommand("train", "Train a model");
  const auto o = std::make_shared<Options>();
  command->add_option("config", o->config,
                      fmt::format("A configuration file or a preset: {}", fmt::join(preset_names(), ", ")));
  add_set_option(*command, o->set);
  command->add_option(
      "--data", o->data,
      "rooms:SEED draws new rooms at every step; or a shard, a folder of shards, or a data set of "
      "another format that vkopple convert knows");
  command->add_option("--out", o->out, "Folder of the run: checkpoints and log.jsonl")->required();
  // Negative numbers would wrap around.
  command
      ->add_option("--steps", o->steps,
                   "Steps of the whole run over all stages; the last stage ends there (default: what the "
                   "configuration says, and 15,125,000 triplets for a stage without end)")
      ->check(CLI::NonNegativeNumber);
  const CLI::Range batches(1, kLargestBatch);
  command
      ->add_option_function<std::string>(
          "--batch",
          [o](const std::string& text) {
            o->fit_batch = text == kFitBatch;
            if (!o->fit_batch) o->batch = std::stoi(text, nullptr, 0);  // as the check reads it
          },
          "Triplets of a step, in every stage; auto: as many as the configuration says, in the fewest equal "
          "portions (--accumulate) with which each stage takes at most nine tenths of the device's free "
          "memory, and half a GiB less on a CPU")
      ->type_name("auto|N")
      ->check(CLI::Validator(
          [batches](std::string& text) { return text == kFitBatch ? std::string() : batches(text); }, ""));
  command
      ->add_option("--accumulate", o->accumulate,
                   "Work off a step's batch in so many equal portions, one after the other, whose gradients' "
                   "mean makes the step: less memory, batch norms of smaller batches (default: what the "
                   "configuration says, 1 where it says nothing)")
      ->check(batches);
  command->add_option("--seed", o->seed, "Of weights, order and dropout (default: 0)")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--checkpoint-every", o->checkpoint_every,
                   "Steps between checkpoints step-NNNNNN.safetensors; 0: none. "
                   "latest.safetensors is written then, every ten minutes, and at the end")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--keep", o->keep,
                   "Numbered checkpoints that stay, the last ones; 0: all. best.safetensors and "
                   "latest.safetensors stay beside them")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--eval-every", o->eval_every,
                   "Steps between measurements in unseen rooms: of depth, and of masks once objects are "
                   "learned; 0: none")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--max-bad-steps", o->max_bad_steps,
                   "Steps in a row that may be skipped, as a loss or a gradient is not finite; at so many "
                   "training stops and says what was first not to be")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option(
      "--profile", o->profile,
      "Write a trace of a step, for chrome://tracing or Perfetto: every dispatch on the device, "
      "and the host's work");
  command->add_option("--profile-steps", o->profiled_steps, "Steps of the trace, which leaves out the first")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--data-threads", o->data_threads,
                   "Threads that read files ahead, each a batch; changes nothing in what is learned")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  command->add_option("--weights", o->weights,
                      "Begin with the weights of a checkpoint, or of the run in a folder, in place of random "
                      "ones; its model must have the same sizes, training and losses may differ");
  command->add_flag("--resume", o->resume,
                    "Go on with the run in --out, to the same bytes as if it had never stopped");
  command->add_flag_callback(
      "--deterministic", [] {},
      "Take every sum in a fixed order, so that two runs on a device give the same bytes; the default, "
      "and so far the only way there is");
  command->add_flag("--sync-batch-norm", o->sync_batch_norm,
                    "Under mpirun: batch norms take their statistics over the batches of all processes");
  command->add_flag("--quiet", o->output.quiet, "Say nothing but errors and warnings");
  command->add_flag(
      "--json", o->output.json,
      "Print JSON, an object a line: what log.jsonl gets of every step, then what became of the run");
  add_winograd_option(*command, o->winograd);
  add_precision_option(*command, o->precision, "what the configuration says, float32 where it says nothing");
  add_device_option(*command, o->device);
  add_kernels_option(*command, o->kernels);
  command->footer(
      "Examples: vkopple train small --data rooms:1 --out run --steps 2500\n"
      "          vkopple train --out run --steps 10000 --resume\n"
      "          vkopple train full --data rooms:1 --out run --batch auto\n"
      "          vkopple train full --data rooms:1 --out run --batch 20 --accumulate 4\n"
      "          vkopple train small --set training.stages=[] --weights run --data rooms:2 --out other\n"
      "          vkopple train small --data rooms:1 --out run --quiet --json | jq .losses.total\n"
      "          mpirun -n 4 vkopple train full --data rooms:1 --out run");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
