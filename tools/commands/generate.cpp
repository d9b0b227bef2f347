#include "train/rooms/generate.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "models/config.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/set_option.h"
#include "tools/stage_rooms.h"
#include "train/count_progress.h"
#include "train/interrupt.h"

namespace vkopple {
namespace {

struct Options {
  std::string out;
  uint64_t scenes = 0;
  uint64_t seed = 0;
  std::optional<int> size, height, width, frames;
  std::string config = "small";
  std::vector<std::string> set;
  std::string stage;
  size_t scenes_per_shard = GenerateOptions{.lens = {1, 1, 1}}.scenes_per_shard;
  std::string device;
  bool json = false;
};

GenerateOptions generate_options(const Options& o) {
  const Config config = Config::load(o.config, o.set);
  GenerateOptions options{.folder = o.out, .scenes = o.scenes, .seed = o.seed, .lens = Lens(config.model)};
  options.lens.height = o.size.value_or(o.height.value_or(options.lens.height));
  options.lens.width = o.size.value_or(o.width.value_or(options.lens.width));
  options.rooms = o.stage.empty() ? config.rooms : rooms_of_stage(config, o.stage);
  options.rooms.frames = o.frames.value_or(options.rooms.frames);
  options.scenes_per_shard = o.scenes_per_shard;
  return options;
}

void report(const Options& o, const GenerateOptions& made) {
  const uint64_t shards = (made.scenes + made.scenes_per_shard - 1) / made.scenes_per_shard;
  if (o.json) {
    const nlohmann::ordered_json out{{"folder", o.out},
                                     {"shards", shards},
                                     {"scenes", made.scenes},
                                     {"frames", made.rooms.frames},
                                     {"height", made.lens.height},
                                     {"width", made.lens.width},
                                     {"seed", made.seed}};
    fmt::print("{}\n", out.dump(2));
    return;
  }
  const auto count = [](uint64_t n, const char* thing) {
    return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s");
  };
  fmt::print("{}: {} of {} frames, {} x {} pixels, in {}\n", o.out, count(made.scenes, "scene"),
             made.rooms.frames, made.lens.width, made.lens.height, count(shards, "shard"));
}

void run(const Options& o) {
  const GenerateOptions options = generate_options(o);
  const Device device({.selector = o.device});
  const Interrupt interrupt;
  CountProgress progress("scenes", options.scenes);
  generate_rooms(device, options, [&](uint64_t done) {
    if (interrupt.requested() && done < options.scenes)
      throw Error(fmt::format("{}: stopped after {} of {} scenes; the shards that are there are complete",
                              o.out, done, options.scenes));
    progress.show(done);
  });
  progress.clear();
  report(o, options);
}

}  // namespace

void add_generate(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("generate", "Draw scenes of rooms with moving objects into tar shards");
  const auto o = std::make_shared<Options>();
  const CLI::Range sides(kSmallestImage, kLargestImage);
  command->add_option("out", o->out, "Folder for the shards; it may not hold any yet")->required();
  command->add_option("--scenes", o->scenes, "How many scenes")
      ->required()
      ->check(CLI::Range(uint64_t{1}, uint64_t{1'000'000'000}));
  command->add_option("--seed", o->seed, "The same seed gives the same scenes")
      ->required()
      ->check(CLI::NonNegativeNumber);  // else a negative number would wrap around
  CLI::Option* size =
      command->add_option("--size", o->size, "Height and width in pixels (default: the configuration's)")
          ->check(sides);
  command->add_option("--height", o->height, "Height in pixels")->check(sides)->excludes(size);
  command->add_option("--width", o->width, "Width in pixels")->check(sides)->excludes(size);
  command->add_option("--frames", o->frames, "Frames of a scene (default: the configuration's)")
      ->check(CLI::Range(3, 100));
  command
      ->add_option("--config", o->config,
                   "Whose rooms and angle of view: a configuration file or a preset (full, small, tiny)")
      ->capture_default_str();
  add_set_option(*command, o->set);
  command->add_option("--stage", o->stage, "The rooms of that stage of the configuration's training");
  command->add_option("--scenes-per-shard", o->scenes_per_shard, "Scenes in one tar file")
      ->capture_default_str()
      ->check(CLI::Range(1, 100'000));
  add_device_option(*command, o->device);
  command->add_flag("--json", o->json, "Print JSON");
  command->footer(
      "Examples: vkopple generate rooms --scenes 64 --seed 2\n"
      "          vkopple generate rooms --scenes 1000 --seed 2 --size 128 --frames 3 --stage depth");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
