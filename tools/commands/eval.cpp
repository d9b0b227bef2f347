#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>

#include "models/config.h"
#include "models/perception.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/precision_option.h"
#include "tools/set_option.h"
#include "tools/stage_rooms.h"
#include "train/baselines/baselines.h"
#include "train/checkpoint.h"
#include "train/count_progress.h"
#include "train/data/open_source.h"
#include "train/evaluate.h"
#include "train/image_io.h"
#include "train/pictures.h"
#include "train/trained_networks.h"
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
  bool baselines = false;
  std::string config = "small";
  std::vector<std::string> set;
  bool json = false;
  Precision precision = Precision::kFloat32;
  std::string device;
};

struct Images {
  std::unique_ptr<TripletSource> source;
  int batch;
  int64_t count;  ///< as many as there are
};

/// `rooms`: without --stage.
Images open_images(const Options& o, const Device& device, const Config& config, const RoomsConfig& rooms) {
  const auto batch = static_cast<int>(std::min<int64_t>(o.batch, o.images));
  auto source = open_triplets(device, o.data, Lens(config.model),
                              o.stage.empty() ? rooms : rooms_of_stage(config, o.stage), batch,
                              {.reading = Reading::kEvaluation, .scenes = static_cast<uint64_t>(o.images)});
  const int64_t count = std::min(o.images, static_cast<int64_t>(source->size().value_or(INT64_MAX)));
  return {std::move(source), batch, count};
}

void write_grid(const Options& o, std::vector<std::vector<RgbImage>> grid, bool objects) {
  constexpr std::ptrdiff_t kInferredObjects = 1;
  if (!objects)
    for (auto& row : grid) row.erase(row.begin() + kInferredObjects);
  write_png(o.grid, picture_grid(grid));
  fmt::print(stderr, "{}: image, {}true objects, inferred depth, true depth\n", o.grid,
             objects ? "inferred objects, " : "");
}

/// `counted`: scores that tell what was left out.
void report(const Options& o, const Images& images, const EvaluationScores& counted, const Json& json,
            const std::vector<ScoreColumn>& columns) {
  if (images.count < o.images)
    fmt::print(stderr, "{}: {} of {} images scored, there are no more\n", o.data, images.count, o.images);
  for (const std::string& line : counted.left_out()) fmt::print(stderr, "{}: {}\n", o.data, line);
  fmt::print("{}", o.json ? json.dump(2) + "\n" : score_table(columns));
}

void score_baselines_alone(const Options& o, const Device& device) {
  const Config config = Config::load(o.config, o.set);
  const Images images = open_images(o, device, config, config.rooms);
  Baselines baselines(config.model.slots);
  CountProgress progress("images", static_cast<uint64_t>(images.count));
  evaluate_baselines(baselines, *images.source, images.count,
                     [&](int64_t done) { progress.show(static_cast<uint64_t>(done)); });
  progress.clear();
  Json json = baselines.truth().counts_json();
  json["baselines"] = baselines.to_json();
  report(o, images, baselines.truth(), json, baselines.columns());
}

void score_model(const Options& o, const Device& device) {
  const LoadedModel model = load_model(device, o.model);
  if (o.data == model.position.data)
    spdlog::warn("the model was trained on {}, so this tells nothing of what it does with new images", o.data);
  const Images images = open_images(o, device, model.config, model.rooms());
  warn_if_untrained(model, {Network::kDepth, Network::kObject});

  Perception perception(device, model.config.model, model.store->groups(),
                        {.batch = images.batch, .precision = o.precision});
  std::vector<std::vector<RgbImage>> grid;
  Baselines baselines(model.config.model.slots);
  CountProgress progress("images", static_cast<uint64_t>(images.count));
  const EvaluationScores scores =
      evaluate(perception, *images.source, images.count,
               {.grid = o.grid.empty() ? nullptr : &grid,
                .grid_rows = o.rows,
                .baselines = o.baselines ? &baselines : nullptr,
                .progress = [&](int64_t done) { progress.show(static_cast<uint64_t>(done)); }});
  progress.clear();
  Json json = scores.to_json();
  std::vector<ScoreColumn> columns{{"model", &scores}};
  if (o.baselines) {
    json["baselines"] = baselines.to_json();
    for (const ScoreColumn& column : baselines.columns()) columns.push_back(column);
  }
  report(o, images, scores, json, columns);
  if (!o.grid.empty()) write_grid(o, std::move(grid), has_learned(model, Network::kObject));
}

void run(const Options& o) {
  if (o.model.empty() && !o.baselines)
    throw UsageError("eval: give a model to score, or --baselines to score these alone");
  const Device device({.selector = o.device, .tuned = load_tuned_choices});
  if (o.model.empty())
    score_baselines_alone(o, device);
  else
    score_model(o, device);
}

}  // namespace

void add_eval(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("eval", "Score a model, or baselines, on images whose objects and depth are known");
  const auto o = std::make_shared<Options>();
  CLI::Option* model = command->add_option(
      "model", o->model, "A checkpoint, or the folder of a run; may be left out with --baselines");
  command
      ->add_option(
          "--data", o->data,
          "rooms:SEED draws rooms with the options of the model or of --config; or a shard, a folder of "
          "shards, or a data set of another format that vkopple convert knows, of which the middle "
          "frame of every scene is scored")
      ->required();
  command->add_option("--images", o->images, "How many, if there are as many")
      ->capture_default_str()
      ->check(CLI::Range(int64_t{1}, int64_t{1'000'000'000}));
  command->add_option("--batch", o->batch, "Images at once; changes no score")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  CLI::Option* grid =
      command->add_option("--grid", o->grid, "Write the first images with what is seen as a PNG")->needs(model);
  command->add_option("--rows", o->rows, "Images in the grid")
      ->capture_default_str()
      ->check(CLI::Range(1, 64))
      ->needs(grid);
  command->add_option("--stage", o->stage,
                      "With rooms:SEED: the rooms of that stage of training (default: of the last one trained; "
                      "without a model, the configuration's own)");
  command->add_flag(
      "--baselines", o->baselines,
      "Score what needs no learning on the same images: all background, one object, random masks, "
      "k-means on colour and place, the true masks");
  command
      ->add_option(
          "--config", o->config,
          "Without a model, size, angle of view, slots and rooms: a configuration file or a preset (full, "
          "small, tiny)")
      ->capture_default_str()
      ->excludes(model);
  add_set_option(*command, o->set)->excludes(model);
  command->add_flag("--json", o->json, "Print JSON");
  add_precision_option(*command, o->precision, "float32");
  add_device_option(*command, o->device);
  command->footer(
      "Examples: vkopple eval run/latest.safetensors --data rooms:2\n"
      "          vkopple eval run/latest.safetensors --data rooms --images 64 --grid grid.png --json\n"
      "          vkopple eval run/latest.safetensors --data rooms:2 --baselines\n"
      "          vkopple eval --baselines --data rooms:9001 --config full");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
