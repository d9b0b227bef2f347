#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>

#include "models/perception.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/precision_option.h"
#include "tools/stage_rooms.h"
#include "train/trained_networks.h"
#include "train/checkpoint.h"
#include "train/count_progress.h"
#include "train/data/open_source.h"
#include "train/evaluate.h"
#include "train/image_io.h"
#include "train/pictures.h"
#include "train/tuning_file.h"

namespace vkopple {
namespace {

struct Options {
  std::string model;
  std::string data;
  int64_t images = 200;
  int batch = 8;
  std::string grid;
  size_t rows = 6;
  std::string stage;
  bool json = false;
  Precision precision = Precision::kFloat32;
  std::string device;
};

std::unique_ptr<TripletSource> open_data(const Options& o, const Device& device, const LoadedModel& model,
                                         int batch) {
  if (o.data == model.position.data)
    spdlog::warn("the model was trained on {}, so this tells nothing of what it does with new images", o.data);
  const RoomsConfig rooms = o.stage.empty() ? model.rooms() : rooms_of_stage(model.config, o.stage);
  return open_triplets(device, o.data, Lens(model.config.model), rooms, batch,
                       {.reading = Reading::kEvaluation, .scenes = static_cast<uint64_t>(o.images)});
}

void write_grid(const Options& o, std::vector<std::vector<RgbImage>> grid, bool objects) {
  constexpr std::ptrdiff_t kInferredObjects = 1;
  if (!objects)
    for (auto& row : grid) row.erase(row.begin() + kInferredObjects);
  write_png(o.grid, picture_grid(grid));
  fmt::print(stderr, "{}: image, {}true objects, inferred depth, true depth\n", o.grid,
             objects ? "inferred objects, " : "");
}

void run(const Options& o) {
  const Device device({.selector = o.device, .tuned = load_tuned_choices});
  const LoadedModel model = load_model(device, o.model);
  const auto batch = static_cast<int>(std::min<int64_t>(o.batch, o.images));
  const auto source = open_data(o, device, model, batch);
  const int64_t images = std::min(o.images, static_cast<int64_t>(source->size().value_or(INT64_MAX)));
  warn_if_untrained(model, {Network::kDepth, Network::kObject});

  Perception perception(device, model.config.model, model.store->groups(),
                        {.batch = batch, .precision = o.precision});
  std::vector<std::vector<RgbImage>> grid;
  CountProgress progress("images", static_cast<uint64_t>(images));
  const EvaluationScores scores =
      evaluate(perception, *source, images, o.grid.empty() ? nullptr : &grid, o.rows,
               [&](int64_t done) { progress.show(static_cast<uint64_t>(done)); });
  progress.clear();
  if (images < o.images)
    fmt::print(stderr, "{}: {} of {} images scored, there are no more\n", o.data, images, o.images);
  for (const std::string& line : scores.left_out()) fmt::print(stderr, "{}: {}\n", o.data, line);
  fmt::print("{}", o.json ? scores.to_json().dump(2) + "\n" : scores.to_table());
  if (!o.grid.empty()) write_grid(o, std::move(grid), has_learned(model, Network::kObject));
}

}  // namespace

void add_eval(CLI::App& app) {
  CLI::App* command = app.add_subcommand("eval", "Score a model on images whose objects and depth are known");
  const auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "A checkpoint, or the folder of a run")->required();
  command
      ->add_option(
          "--data", o->data,
          "rooms:SEED draws rooms with the options that the model carries; or a shard, a folder of shards, or "
          "a data set of another format that vkopple convert knows, of which the middle frame of every "
          "scene is scored")
      ->required();
  command->add_option("--images", o->images, "How many, if there are as many")
      ->capture_default_str()
      ->check(CLI::Range(int64_t{1}, int64_t{1'000'000'000}));
  command->add_option("--batch", o->batch, "Images at once; changes no score")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  CLI::Option* grid =
      command->add_option("--grid", o->grid, "Write the first images with what is seen as a PNG");
  command->add_option("--rows", o->rows, "Images in the grid")
      ->capture_default_str()
      ->check(CLI::Range(1, 64))
      ->needs(grid);
  command->add_option(
      "--stage", o->stage,
      "With rooms:SEED: the rooms of that stage of training (default: of the last one trained)");
  command->add_flag("--json", o->json, "Print JSON");
  add_precision_option(*command, o->precision, "float32");
  add_device_option(*command, o->device);
  command->footer(
      "Examples: vkopple eval run/latest.safetensors --data rooms:2\n"
      "          vkopple eval run/latest.safetensors --data rooms --images 64 --grid grid.png --json");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
