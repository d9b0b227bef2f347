#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <span>

#include "models/config.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/set_option.h"
#include "tools/stage_rooms.h"
#include "train/contrast/data_contrast.h"
#include "train/contrast/room_motion.h"
#include "train/count_progress.h"
#include "train/data/open_source.h"
#include "train/rooms/room_source.h"

namespace vkopple {
namespace {

constexpr int64_t kScenesAtOnce = 8;

struct Options {
  std::string data;
  std::string config = "small";
  std::vector<std::string> set;
  std::string stage;
  int64_t images = 200;
  bool json = false;
  std::string device;
};

uint64_t seed_of(const std::string& data) {
  if (const auto seed = rooms_seed(data)) return *seed;
  throw UsageError(
      fmt::format("--data {}: how objects move is known of generated rooms alone; give rooms:SEED", data));
}

DataContrast measure(const Options& o, const Config& config, const RoomsConfig& rooms) {
  const uint64_t seed = seed_of(o.data);
  const Device device({.selector = o.device});
  const Lens lens(config.model);
  const auto batch = static_cast<int>(std::min(o.images, kScenesAtOnce));
  RoomSource source(device, lens, rooms, batch, seed);
  DataContrast contrast(lens, config.model.beta);
  CountProgress progress("triplets", static_cast<uint64_t>(o.images));
  for (uint64_t step = 0; contrast.triplets() < o.images; ++step) {
    const TripletBatch seen = source.read(step);
    const std::vector<RoomTriplet> known = source.scenes(step);
    for (std::size_t b = 0; b < known.size() && contrast.triplets() < o.images; ++b) {
      const std::size_t area = lens.pixels();
      contrast.add({.image = std::span(seen.images[1]).subspan(3 * area * b, 3 * area),
                    .next = std::span(seen.images[2]).subspan(3 * area * b, 3 * area),
                    .depth = std::span(seen.depth).subspan(area * b, area),
                    .label = std::span(seen.label).subspan(area * b, area),
                    .motion = room_motion(known[b])});
    }
    progress.show(static_cast<uint64_t>(contrast.triplets()));
  }
  return contrast;
}

void run(const Options& o) {
  const Config config = Config::load(o.config, o.set);
  const DataContrast contrast =
      measure(o, config, o.stage.empty() ? config.rooms : rooms_of_stage(config, o.stage));
  if (o.json) {
    fmt::print("{}\n", contrast.to_json().dump(2));
    return;
  }
  fmt::print("{}: {} triplet{} of {} x {} pixels\n{}", o.data, contrast.triplets(),
             contrast.triplets() == 1 ? "" : "s", config.model.width, config.model.height, contrast.to_text());
}

}  // namespace

void add_data_contrast(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "data-contrast", "Tell how much of the image loss depth and moving objects have to win on rooms");
  const auto o = std::make_shared<Options>();
  command->add_option("--data", o->data, "rooms:SEED, of which depth, masks and all motion are known")
      ->required();
  command
      ->add_option(
          "--config", o->config,
          "Whose rooms, size, angle of view and beta of the warp: a configuration file or a preset (full, "
          "small, tiny)")
      ->capture_default_str();
  add_set_option(*command, o->set);
  command->add_option("--stage", o->stage, "The rooms of that stage of the configuration's training");
  command->add_option("--images", o->images, "How many triplets")
      ->capture_default_str()
      ->check(CLI::Range(int64_t{1}, int64_t{1'000'000'000}));
  command->add_flag("--json", o->json, "Print JSON");
  add_device_option(*command, o->device);
  command->footer(
      "Examples: vkopple data-contrast --data rooms:9001\n"
      "          vkopple data-contrast --data rooms:9001 --config full --set rooms.camera_step=0.3 --images 50 "
      "--json");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
