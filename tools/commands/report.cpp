#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "models/perception.h"
#include "runtime/device.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/output_folder.h"
#include "train/atomic_file.h"
#include "train/checkpoint.h"
#include "train/count_progress.h"
#include "train/data/open_source.h"
#include "train/predictor.h"
#include "train/report/report_page.h"
#include "train/report/shell_word.h"
#include "train/run_folder.h"
#include "train/trained_networks.h"
#include "train/tuning_file.h"

namespace vkopple {
namespace {

constexpr int kBatch = 8;

struct Options {
  std::string model;
  std::string out;
  std::string data = "rooms:9001";
  int64_t images = 64;
  bool json = false;
  std::string device;
};

std::string command_line(const Options& o) {
  return fmt::format("vkopple report {} --out {} --data {} --images {}{}", shell_word(o.model),
                     shell_word(o.out), shell_word(o.data), o.images,
                     o.device.empty() ? "" : " --device " + shell_word(o.device));
}

std::vector<Network> untrained(const LoadedModel& model) {
  std::vector<Network> networks = networks_of(model.config.model);
  std::erase_if(networks, [&](Network network) { return has_learned(model, network); });
  return networks;
}

std::optional<TrainingCurves> curves_beside(const std::filesystem::path& model) {
  const std::filesystem::path log = RunFolder(named_checkpoint(model).parent_path()).log();
  if (!std::filesystem::exists(log)) return std::nullopt;
  return read_training_curves(log);
}

HeldOut look(const Options& o, const Device& device, const LoadedModel& model, TripletSource& source,
             int batch) {
  const int64_t images = std::min(o.images, static_cast<int64_t>(source.size().value_or(INT64_MAX)));
  Perception perception(device, model.config.model, model.store->groups(), {.batch = batch});
  CountProgress progress("images", static_cast<uint64_t>(images));
  return look_at_held_out(perception, source, images, {},
                          [&](int64_t done) { progress.show(static_cast<uint64_t>(done)); });
}

std::vector<Prediction> predict(const Device& device, const LoadedModel& model,
                                const std::vector<TripletFrames>& triplets) {
  std::vector<Prediction> predictions;
  if (triplets.empty()) return predictions;
  Predictor predictor(device, model.config.model, model.store->groups());
  CountProgress progress("predictions", triplets.size());
  for (const TripletFrames& triplet : triplets) {
    predictions.push_back({triplet, predictor.predict(triplet.frames[0], triplet.frames[1], triplet.poses)});
    progress.show(predictions.size());
  }
  return predictions;
}

void tell(const Options& o, const std::filesystem::path& page, const EvaluationScores& scores) {
  if (o.json)
    fmt::print("{}\n", nlohmann::ordered_json{{"page", page.string()}, {"scores", scores.to_json()}}.dump(2));
  else
    fmt::print("{}\n{}", page.string(), score_table({{"", &scores}}));
}

void run(const Options& o) {
  const Device device({.selector = o.device, .tuned = load_tuned_choices});
  const LoadedModel model = load_model(device, o.model);
  const Lens lens(model.config.model);
  const auto batch = static_cast<int>(std::min<int64_t>(kBatch, o.images));
  if (o.data == model.position.data)
    spdlog::warn("the model was trained on {}, so this tells nothing of what it does with new images", o.data);
  const auto source =
      open_triplets(device, o.data, lens, model.rooms(), batch,
                    {.reading = Reading::kEvaluation, .scenes = static_cast<uint64_t>(o.images)});
  Report report{.model = o.model,
                .command = command_line(o),
                .version = VKOPPLE_VERSION,
                .device = device.caps(),
                .config = model.config,
                .position = model.position,
                .untrained = untrained(model),
                .curves = curves_beside(o.model),
                .data = o.data,
                .half_view = lens.half_view()};
  const OutputFolder folder(o.out);
  warn_if_untrained(model, networks_of(model.config.model));
  report.held_out = look(o, device, model, *source, batch);
  report.predictions = predict(device, model, report.held_out.triplets);
  if (const int64_t scored = report.held_out.scores.images(); scored < o.images)
    fmt::print(stderr, "{}: {} of {} images scored, there are no more\n", o.data, scored, o.images);
  const std::filesystem::path page = folder / "index.html";
  write_file(page, report_page(report));
  tell(o, page, report.held_out.scores);
}

}  // namespace

void add_report(CLI::App& app) {
  CLI::App* command = app.add_subcommand("report", "Write a page that shows how good a model is");
  const auto o = std::make_shared<Options>();
  command
      ->add_option("model", o->model,
                   "A checkpoint, or the folder of a run; the log beside it gives the curves of training")
      ->required();
  command->add_option("--out", o->out, "Folder for index.html, which needs no other file")->required();
  command
      ->add_option("--data", o->data,
                   "rooms:SEED draws rooms with the options that the model carries; or a shard, a folder of "
                   "shards, or a data set of another format that vkopple convert knows")
      ->capture_default_str();
  command->add_option("--images", o->images, "How many are scored, if there are as many")
      ->capture_default_str()
      ->check(CLI::Range(int64_t{1}, int64_t{1'000'000'000}));
  command->add_flag("--json", o->json, "Print JSON: where the page lies, and the scores");
  add_device_option(*command, o->device);
  command->footer(
      "Examples: vkopple report run --out report\n"
      "          vkopple report run/step-000300.safetensors --data rooms --images 200 --out report --json");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
