#include "train/trainer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/memory_budget.h"
#include "train/data/open_source.h"
#include "train/held_out_probe.h"
#include "train/parallel/agreement.h"
#include "train/parallel/memory_share.h"
#include "train/step_batch.h"
#include "train/tensorboard/training_board.h"
#include "train/training_step.h"

namespace vkopple {
namespace {

// Whoever sets the system's clock changes nothing here.
using Clock = std::chrono::steady_clock;
static_assert(Clock::is_steady);

/// All weights and gradients are read for them.
constexpr uint64_t kNormsEvery = 50;
/// Measurements between two pictures, which take far more room than numbers.
constexpr uint64_t kPicturesEvery = 10;
// Rooms to measure in are never those of training, whose seeds are small numbers as a rule.
constexpr uint64_t kProbeSeedDistance = 1'000'003;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// 32 bits made of all 64: what dropout's random numbers take.
uint32_t folded(uint64_t number) { return static_cast<uint32_t>(number ^ (number >> 32)); }

std::string stage_text(const PlannedStage& planned) {
  const TrainingStage& s = planned.stage;
  std::vector<std::string_view> networks;
  for (const Network network : s.networks) networks.push_back(kNetworkNames[static_cast<size_t>(network)]);
  const std::string portions = s.accumulate > 1 ? fmt::format(" in {} portions", s.accumulate) : "";
  return fmt::format("stage {}: steps {} to {}, batch {}{}, learning rate {}, training {}", s.name,
                     planned.begin + 1, planned.end, s.batch, portions, s.learning_rate,
                     fmt::join(networks, ", "));
}

}  // namespace

TrainingSetting training_setting(const TrainerOptions& options) {
  const bool leads = options.peers == nullptr || options.peers->rank() == 0;
  return {
      .drawn = names_rooms(options.data), .measured = options.eval_every > 0 && leads, .peers = options.peers};
}

/// What one stage needs at hand.
struct Trainer::Stage {
  const PlannedStage* planned;
  std::unique_ptr<TripletSource> source;
  std::unique_ptr<TrainingStep> training;
  std::unique_ptr<HeldOutProbe> probe;
};

/// What a run tells of itself beside its checkpoints.
struct Trainer::Diary {
  TrainingLog log;
  TrainingBoard board;
};

Trainer::Trainer(const Device& device, Config config, TrainerOptions options, bool resume)
    : device_(&device),
      config_(std::move(config)),
      options_(std::move(options)),
      plan_(config_, options_.steps),
      store_(device, config_.model, config_.training.precision),
      keeper_(options_.folder, options_.keep, resume && leads(), *options_.files,
              [this](const auto& path, const auto& more) {
                save_checkpoint(path, store_, config_, position_, more, *options_.files);
              }),
      saved_at_(Clock::now()) {
  if (resume) {
    const std::filesystem::path checkpoint = resumed_checkpoint();
    require_memory_from(read_checkpoint_header(checkpoint).position.step);
    position_ = load_checkpoint(checkpoint, store_, config_);
    if (checkpoint == options_.folder.latest()) saved_step_ = position_.step;
  } else {
    require_memory_from(0);
    if (options_.weights.empty())
      store_.initialise(options_.seed);
    else
      load_weights(options_.weights, store_);
    position_.seed = options_.seed;
  }
  position_.data = options_.data;
  require_same(options_.peers,
               fmt::format("{} {} {} {} {}", config_.to_json(), position_.step, position_.seed, position_.data,
                           plan_.steps()),
               "configuration, data, seed or checkpoint");
  if (!options_.profile.empty() && leads())
    profiler_.emplace(device.caps(), options_.profile, options_.profiled_steps);
}

Trainer::~Trainer() = default;

std::filesystem::path Trainer::resumed_checkpoint() const {
  return options_.checkpoint.empty() ? options_.folder.latest() : options_.checkpoint;
}

/// For the stages that go on beyond a step.
void Trainer::require_memory_from(uint64_t step) const {
  std::vector<PlannedStage> stages;
  for (const PlannedStage& planned : plan_.stages())
    if (planned.end > step) stages.push_back(planned);
  const uint64_t free = options_.free_memory.value_or(free_memory(*device_));
  require_memory(device_->caps(), config_, stages, training_setting(options_),
                 memory_share(free, device_->caps(), options_.peers), step > 0);
}

Trainer::Stage Trainer::open_stage(const PlannedStage& planned) {
  const TrainingStage& s = planned.stage;
  const Lens lens(config_.model);
  Stage stage{.planned = &planned, .source = nullptr, .training = nullptr, .probe = nullptr};
  stage.training = std::make_unique<TrainingStep>(*device_, config_, s, store_.groups(),
                                                  profiler_ && !profiler_->done(), options_.peers);
  stage.source =
      open_triplets(*device_, options_.data, lens, s.rooms, static_cast<int>(stage.training->batch()),
                    {.reading = Reading::kTraining,
                     .seed = position_.seed,
                     .threads = options_.data_threads,
                     .part = part(),
                     .portions = static_cast<uint64_t>(s.accumulate)});
  if (options_.eval_every > 0 && leads())
    stage.probe = std::make_unique<HeldOutProbe>(
        store_, s.model_in(config_.model), s.rooms,
        HeldOutProbe::Options{.batch = probe_batch(s),
                              // Whatever the data, it is measured in rooms.
                              .seed = rooms_seed(options_.data).value_or(0) + kProbeSeedDistance,
                              .objects = s.hypotheses != Hypotheses::kBackground});
  return stage;
}

Triplets Trainer::triplets_of(Stage& stage, uint64_t step, int portion) const {
  const TrainingStage& s = stage.planned->stage;
  return training_triplets(*stage.source, position_.seed, step, s.batch, config_.training.reverse_probability,
                           stage.training->model().first_frame(), part(),
                           {static_cast<uint64_t>(portion), static_cast<uint64_t>(s.accumulate)});
}

StepRecord Trainer::train_step(Stage& stage, Trace* trace) {
  const auto start = Clock::now();
  const TrainingStage& s = stage.planned->stage;
  const uint64_t step = position_.step;
  StepRecord record{
      .stage = s.name, .batch = s.batch, .learning_rate = s.learning_rate_at(step - stage.planned->begin)};
  stage.training->set_learning_rate(record.learning_rate);
  const auto shown = [&](int portion) {
    const auto asked = Clock::now();
    const Trace::Span span(trace, "data");
    Triplets triplets = triplets_of(stage, step, portion);
    record.data_seconds += seconds_since(asked);
    return triplets;
  };
  record.losses = stage.training->run(shown, folded(position_.seed), folded(step), trace);
  record.skipped = stage.training->skipped();
  if (record.skipped) {
    ++position_.skipped;
    ++position_.skipped_in_a_row;
  } else {
    position_.skipped_in_a_row = 0;
    store_.count_step(s.hypotheses == Hypotheses::kBackground, s.model_in(config_.model).slots, s.accumulate);
  }
  record.skipped_steps = position_.skipped;
  record.seconds = seconds_since(start);
  if (several(options_.peers)) record.shared = shared(stage.training->exchange_seconds(), record.seconds);
  position_.step = step + 1;
  position_.stage = plan_.stage_of(step);
  position_.stage_step = position_.step - stage.planned->begin;
  record.step = position_.step;
  if (leads() && !record.skipped && position_.step % kNormsEvery == 0) record.norms = stage.training->norms();
  return record;
}

void Trainer::require_progress(Stage& stage) const {
  if (position_.skipped_in_a_row < options_.max_bad_steps) return;
  const uint64_t step = position_.step - 1;
  const std::string diagnosis = stage.training->diagnosis(
      [&](int portion) { return triplets_of(stage, step, portion); }, folded(position_.seed), folded(step));
  throw Error(fmt::format(
      "step {}: {} steps in a row were skipped, as a loss or a gradient was not finite: {}; the checkpoints "
      "before stay, try a smaller learning rate",
      position_.step, position_.skipped_in_a_row, diagnosis));
}

void Trainer::measure(Stage& stage, Diary& diary, StepRecord& record) {
  if (!stage.probe || position_.step % options_.eval_every != 0) return;
  const uint64_t measurement = position_.step / options_.eval_every;
  const bool pictured = measurement == 1 || measurement % kPicturesEvery == 0;
  std::vector<std::vector<RgbImage>> pictures;
  record.held_out = stage.probe->measure(pictured ? &pictures : nullptr);
  diary.board.show(position_.step, pictures);
}

BatchPart Trainer::part() const {
  if (!several(options_.peers)) return {};
  return {static_cast<uint64_t>(options_.peers->rank()), static_cast<uint64_t>(options_.peers->count())};
}

/// `waited`: seconds of a step in this process.
SharedStep Trainer::shared(double waited, double seconds) {
  std::array<float, 2> means{static_cast<float>(waited), static_cast<float>(1 - waited / seconds)};
  options_.peers->average(means);
  return {options_.peers->count(), double{means[0]}, double{means[1]}};
}

void Trainer::save(bool numbered) {
  if (!leads()) return;
  if (numbered) {
    keeper_.save_numbered(position_.step);
  } else {
    if (saved_step_ != position_.step) keeper_.save_latest();
    keeper_.remove_old(position_.step);
  }
  saved_step_ = position_.step;
  saved_at_ = Clock::now();
}

void Trainer::save_if_due() {
  const bool numbered = options_.checkpoint_every > 0 && position_.step % options_.checkpoint_every == 0;
  if (numbered || seconds_since(saved_at_) >= options_.seconds_between_saves) save(numbered);
}

bool Trainer::run(TrainingListener& listener, const std::function<bool()>& stop) {
  std::optional<Diary> diary;  // only once all that it needs is there
  bool stopped = false;
  while (position_.step < plan_.steps() && !stopped) {
    const PlannedStage& planned = plan_.stages()[plan_.stage_of(position_.step)];
    Stage stage = open_stage(planned);
    if (leads()) {
      options_.folder.create();
      if (!diary) options_.folder.remove_remains();
      if (!diary)
        diary.emplace(Diary{.log = TrainingLog(options_.folder.log(), position_.step, *options_.files),
                            .board = TrainingBoard(options_.folder.path(), position_.step, *options_.files)});
      listener.say(stage_text(planned));
      if (device_->caps().cpu())
        listener.say("its first step compiles kernels: a minute or two the first time, seconds from then on");
    }
    while (position_.step < planned.end && !stopped) {
      Trace* const trace = profiler_ ? profiler_->begin_step() : nullptr;
      {
        const Trace::Span span(trace, "step");
        StepRecord record = train_step(stage, trace);
        const Trace::Span after(trace, "log and checkpoint");
        if (diary) {
          measure(stage, *diary, record);
          diary->log.add(record);
          diary->board.add(record);
          listener.show(record);
          if (record.held_out) keeper_.save_if_best(*record.held_out);
        }
        require_progress(stage);
        save_if_due();
      }
      if (trace != nullptr) profiler_->end_step();
      stopped = any(options_.peers, stop());
    }
  }
  if (diary) diary->board.flush();
  if (profiler_) profiler_->finish();
  save(false);
  return position_.step >= plan_.steps();
}

}  // namespace vkopple
