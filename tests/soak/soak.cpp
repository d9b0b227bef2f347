#include "tests/soak/soak.h"

#include <fmt/format.h>

#include <iterator>
#include <optional>

#include "models/config.h"
#include "train/atomic_file.h"
#include "train/checkpoint.h"
#include "train/image_io.h"
#include "train/resident_memory.h"
#include "train/rooms/generate.h"
#include "train/seen_image.h"
#include "train/trainer.h"

namespace vkopple::test {
namespace {

constexpr uint64_t kScenes = 20;

/// All networks from step `depth_steps` on, two portions a step; without a number the depth network alone.
Config config(std::optional<uint64_t> depth_steps) {
  const std::string depth = R"("name": "depth", "networks": ["depth"], "hypotheses": "background")";
  const std::string stages =
      depth_steps
          ? fmt::format(R"({{{}, "steps": {}}}, {{"name": "all", "accumulate": 2}})", depth, *depth_steps)
          : fmt::format("{{{}}}", depth);
  return Config::parse(fmt::format(R"({{
      "model": {{"height": 16, "width": 16, "slots": 2, "bins": 12, "code": 12, "depth_width": 2, "object_width": 4,
                 "imagine_width": 1, "lstm": 4}},
      "training": {{"batch": 2, "stages": [{}]}},
      "rooms": {{"frames": 3, "supersample": 1}}}})",
                                   stages),
                       "soak");
}

/// Looks what is held after every round of a phase.
class Rounds final : public TrainingListener {
 public:
  Rounds(std::vector<SoakPhase>& phases, const std::function<void(const SoakPhase&)>& told)
      : phases_(phases), told_(told) {}

  void begin(const std::string& name) {
    phases_.push_back({.name = name, .each = kSoakRound, .rounds = {}});
    done_ = 0;
  }
  void one() {
    if (++done_ % kSoakRound != 0) return;
    phases_.back().rounds.push_back(Holdings::now());
    if (told_) told_(phases_.back());
  }

  void show(const StepRecord& record) override {
    const std::string name = "training, stage " + record.stage + suffix;
    if (phases_.empty() || phases_.back().name != name) begin(name);
    one();
  }
  void say(std::string_view) override {}

  std::string suffix;

 private:
  std::vector<SoakPhase>& phases_;
  const std::function<void(const SoakPhase&)>& told_;
  uint64_t done_ = 0;
};

/// Goes on with the run in a folder, or begins it, up to `steps`.
void train(const Device& device, const Config& config, const std::filesystem::path& folder,
           const std::string& data, uint64_t steps, Rounds& rounds) {
  TrainerOptions options{.folder = RunFolder(folder), .data = data, .steps = steps, .seed = 9};
  options.checkpoint_every = kSoakRound / 2;
  options.keep = 2;
  options.eval_every = kSoakRound / 2;
  Trainer trainer(device, config, options, options.folder.holds_checkpoint());
  trainer.run(rounds, [] { return false; });
}

/// As `vkopple infer` does.
void infer(const Device& device, const std::filesystem::path& run, const std::filesystem::path& image,
           const std::filesystem::path& out, Rounds& rounds) {
  const LoadedModel model = load_model(device, run);
  const ModelConfig& config = model.config.model;
  Perception perception(device, config, model.store->groups(), {.batch = 1});
  for (uint64_t i = 0; i < kSoakRound; ++i) {
    const RgbImage picture = read_rgb(image);
    const SeenImage seen = resize(see_image(perception, resize(picture, config.height, config.width)),
                                  picture.height, picture.width);
    write_depth_exr(out / "seen.depth.exr", seen.depth);
    write_file(out / "seen.json", to_json(seen).dump());
    rounds.one();
  }
}

void note_growth(std::vector<std::string>& lines, const std::string& what, uint64_t before, uint64_t after) {
  if (after > before)
    lines.push_back(fmt::format("{}: {} after the first round, {} at the end", what, before, after));
}

}  // namespace

Holdings Holdings::now() {
  const auto memory = resident_memory();
  const std::filesystem::directory_iterator open("/proc/self/fd");
  // The iterator has one of its own.
  return {.resident_bytes = memory ? memory->now : 0,
          .descriptors = static_cast<uint64_t>(std::distance(begin(open), end(open))) - 1,
          .vulkan = VulkanObjects::now()};
}

std::vector<SoakPhase> soak(const Device& device, const SoakOptions& options,
                            const std::function<void(const SoakPhase&)>& told) {
  const uint64_t third = options.steps / 3 / kSoakRound * kSoakRound;
  const Config trained = config(options.all_networks ? std::optional(third) : std::nullopt);
  const std::filesystem::path run = options.folder / "run", data = options.folder / "data";
  generate_rooms(
      device,
      {.folder = data, .scenes = kScenes, .seed = 5, .lens = Lens(trained.model), .rooms = trained.rooms});
  write_png(options.folder / "image.png", RgbImage(24, 40));
  std::vector<SoakPhase> phases;
  Rounds rounds(phases, told);
  train(device, trained, run, "rooms:1", options.all_networks ? 2 * third : options.steps / 2, rounds);
  rounds.suffix = ", on files";
  train(device, trained, run, data, options.steps, rounds);
  rounds.begin("inference");
  for (uint64_t done = 0; done < options.inferences; done += kSoakRound)
    infer(device, run, options.folder / "image.png", options.folder, rounds);
  return phases;
}

std::vector<std::string> growth(const SoakPhase& phase, uint64_t resident_slack) {
  std::vector<std::string> lines;
  if (phase.rounds.size() < 2) return {phase.name + ": there are no two rounds to compare"};
  const Holdings &warm = phase.rounds.front(), &last = phase.rounds.back();
  note_growth(lines, phase.name + ", open files", warm.descriptors, last.descriptors);
  note_growth(lines, phase.name + ", bytes of device memory", warm.vulkan.memory_bytes,
              last.vulkan.memory_bytes);
  for (const auto& [kind, count] : last.vulkan.counts) {
    const auto before = warm.vulkan.counts.find(kind);
    note_growth(lines, phase.name + ", " + kind, before == warm.vulkan.counts.end() ? 0 : before->second,
                count);
  }
  const Holdings& settled = phase.rounds[(phase.rounds.size() - 1) / 2];
  if (last.resident_bytes > settled.resident_bytes + resident_slack)
    lines.push_back(fmt::format("{}, bytes of resident memory: {} half way, {} at the end", phase.name,
                                settled.resident_bytes, last.resident_bytes));
  return lines;
}

}  // namespace vkopple::test
