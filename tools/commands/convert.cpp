#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "models/config.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/foreign_data_option.h"
#include "train/count_progress.h"
#include "train/formats/fit_scene.h"
#include "train/interrupt.h"

namespace vkopple {
namespace {

struct Options {
  std::string in, out;
  ForeignData data;
  std::string to = "shards";
  std::vector<std::string> to_settings;
  uint64_t limit = UINT64_MAX;
  std::optional<int> size, height, width;
  std::optional<double> fov_degrees;
  std::string config;
  double scale = 1;
  bool json = false;
};

SceneFit scene_fit(const Options& o) {
  SceneFit fit{.scale = o.scale};
  if (!o.config.empty()) {
    const ModelConfig model = Config::load(o.config).model;
    fit.height = static_cast<int>(model.height);
    fit.width = static_cast<int>(model.width);
    fit.fov = model.fov;
  }
  if (o.size) fit.height = fit.width = o.size;
  if (o.height) fit.height = o.height;
  if (o.width) fit.width = o.width;
  if (o.fov_degrees) fit.fov = *o.fov_degrees * std::numbers::pi / 180;
  return fit;
}

void report(const Options& o, uint64_t scenes, uint64_t frames) {
  if (o.json) {
    const nlohmann::ordered_json out{
        {"folder", o.out}, {"format", o.to}, {"scenes", scenes}, {"frames", frames}, {"scale", o.scale}};
    fmt::print("{}\n", out.dump(2));
    return;
  }
  fmt::print("{}: {} scenes, {} frames\n", o.out, scenes, frames);
}

void run(const Options& o) {
  FormatOptions to;
  to.option = "--to-option";
  for (const std::string& text : o.to_settings) add_assignments(text, to.option, to.settings);
  const SceneFit fit = scene_fit(o);
  const auto reader = o.data.open(o.in);
  const auto writer = create_scenes(o.out, o.to, to);
  const Interrupt interrupt;
  CountProgress progress("scenes", std::min(reader->count().value_or(0), o.limit));
  uint64_t scenes = 0, frames = 0;
  while (scenes < o.limit) {
    std::optional<SceneData> scene = reader->next();
    if (!scene) break;
    if (interrupt.requested())
      throw Error(fmt::format("{}: stopped after {} scenes; what is there is incomplete", o.out, scenes));
    frames += scene->frames.size();
    writer->add(fitted(std::move(*scene), fit));
    progress.show(++scenes);
  }
  progress.clear();
  if (scenes == 0) throw Error(fmt::format("{}: no scenes", o.in));
  writer->finish();
  report(o, scenes, frames);
}

}  // namespace

void add_convert(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("convert", "Turn a data set of any format into tar shards, or into another");
  const auto o = std::make_shared<Options>();
  const CLI::Range sides(kSmallestImage, kLargestImage);
  command->add_option("in", o->in, "A file or folder")->required();
  command->add_option("out", o->out, "Folder of the new data set; it may not hold one yet")->required();
  add_foreign_data_options(*command, o->data);
  command->add_option("--to", o->to, "The format to write")->capture_default_str();
  command
      ->add_option("--to-option", o->to_settings,
                   "NAME=VALUE,... of the format that is written; may be repeated. See the list below")
      ->allow_extra_args(false);
  command->add_option("--limit", o->limit, "Convert so many scenes only")
      ->check(CLI::Range(uint64_t{1}, UINT64_MAX));
  CLI::Option* size =
      command
          ->add_option("--size", o->size,
                       "Height and width in pixels; pictures are cropped to the ratio of both, not "
                       "distorted (default: as they are)")
          ->check(sides);
  command->add_option("--height", o->height, "Height in pixels")->check(sides)->excludes(size);
  command->add_option("--width", o->width, "Width in pixels")->check(sides)->excludes(size);
  command
      ->add_option("--fov", o->fov_degrees,
                   "Vertical angle of view in degrees, to which pictures are cropped (default: as it is)")
      ->check(CLI::Range(1.0, 175.0));
  command->add_option("--config", o->config,
                      "Height, width and angle of view of a model: a configuration file or a preset");
  command->add_option("--scale", o->scale, "Multiply all lengths: cameras, depth, objects")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 1e6));
  command->add_flag("--json", o->json, "Print JSON");
  command->footer(
      "Examples: vkopple convert rooms pictures --to recording\n"
      "          vkopple convert freiburg1_desk desk --format-option fov=49.8,every=3 --size 64\n" +
      formats_help(FormatUse::kConverting));
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
