#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "runtime/device.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/output_folder.h"
#include "train/checkpoint.h"
#include "train/frame_poses.h"
#include "train/image_io.h"
#include "train/pictures.h"
#include "train/predictor.h"
#include "train/trained_networks.h"
#include "train/tuning_file.h"

namespace vkopple {
namespace {

struct Options {
  std::string model;
  std::string first, second, truth;
  std::string poses;
  std::vector<int> frames{0, 1, 2};
  std::string out;
  bool json = false;
  std::string device;
};

/// The pictures, at the model's size.
struct Frames {
  RgbImage first, second;
  std::optional<RgbImage> truth;
};

Frames read_frames(const Options& o, const ModelConfig& config) {
  const RgbImage first = read_rgb(o.first);
  const auto fitting = [&](const std::string& path) {
    RgbImage image = read_rgb(path);
    if (image.height == first.height && image.width == first.width) return image;
    throw Error(fmt::format("{}: has {} x {} pixels and {} has {} x {}; frames of one film have one size", path,
                            image.width, image.height, o.first, first.width, first.height));
  };
  const auto small = [&](const RgbImage& image) { return resize(image, config.height, config.width); };
  Frames frames{small(first), small(fitting(o.second)), {}};
  if (!o.truth.empty()) frames.truth = small(fitting(o.truth));
  return frames;
}

Plane<uint8_t> bytes(const Plane<float>& plane) {
  Plane<uint8_t> out(plane.height, plane.width);
  std::transform(plane.pixels.begin(), plane.pixels.end(), out.pixels.begin(),
                 [](float v) { return static_cast<uint8_t>(std::lround(255 * std::clamp(v, 0.0F, 1.0F))); });
  return out;
}

std::string write_comparison(const OutputFolder& folder, const Frames& frames,
                             const PredictedFrame& predicted) {
  std::vector<RgbImage> row{frames.first,       frames.second,       predicted.warped,
                            predicted.imagined, predicted.predicted, grey_picture(predicted.weight)};
  if (frames.truth) row.push_back(*frames.truth);
  const int zoom = zoom_for(frames.first.height);
  for (RgbImage& picture : row) picture = enlarge(picture, zoom);
  write_png(folder / "comparison.png", picture_grid({row}));
  return std::string("frame 1, frame 2, warped, imagined, predicted, weight") + (frames.truth ? ", truth" : "");
}

/// By what was compared with the truth.
nlohmann::ordered_json errors(const Frames& frames, const PredictedFrame& predicted) {
  return {{"predicted", mean_squared_error(predicted.predicted, *frames.truth)},
          {"warped", mean_squared_error(predicted.warped, *frames.truth)},
          {"imagined", mean_squared_error(predicted.imagined, *frames.truth)},
          {"frame_2", mean_squared_error(frames.second, *frames.truth)}};
}

void report(const Options& o, const std::string& columns, const nlohmann::ordered_json& mse) {
  if (o.json) {
    nlohmann::ordered_json out{{"folder", o.out}, {"comparison", columns}};
    if (!mse.is_null()) out["mean_squared_error"] = mse;
    fmt::print("{}\n", out.dump(2));
    return;
  }
  fmt::print("{}/comparison.png: {}\n", o.out, columns);
  if (mse.is_null()) return;
  fmt::print("mean squared error, colours from 0 to 1\n");
  for (const auto& [name, value] : mse.items())
    fmt::print("  {:<10} {:.6f}\n", name == "frame_2" ? "frame 2" : name, value.get<double>());
}

void run(const Options& o) {
  const Device device({.selector = o.device, .tuned = load_tuned_choices});
  const LoadedModel model = load_model(device, o.model);
  const ModelConfig& config = model.config.model;
  const auto poses = read_frame_poses(o.poses, {o.frames[0], o.frames[1], o.frames[2]}, config.fov);
  const Frames frames = read_frames(o, config);
  warn_if_untrained(model, networks_of(model.config.model));

  Predictor predictor(device, config, model.store->groups());
  const PredictedFrame predicted = predictor.predict(frames.first, frames.second, poses);
  const OutputFolder folder(o.out);
  write_png(folder / "warped.png", predicted.warped);
  write_png(folder / "imagined.png", predicted.imagined);
  write_png(folder / "predicted.png", predicted.predicted);
  write_png(folder / "weight.png", bytes(predicted.weight));
  write_depth_exr(folder / "depth.exr", predicted.depth);
  const std::string columns = write_comparison(folder, frames, predicted);
  report(o, columns, frames.truth ? errors(frames, predicted) : nlohmann::ordered_json());
}

}  // namespace

void add_predict(CLI::App& app) {
  CLI::App* command = app.add_subcommand("predict", "Predict the third frame from two frames and the camera");
  const auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "A checkpoint, or the folder of a run")->required();
  command->add_option("frame1", o->first, "The first image")->required();
  command->add_option("frame2", o->second, "The second image")->required();
  command
      ->add_option(
          "--poses", o->poses,
          "The camera in the three frames: JSON {\"poses\": [[x, y, z, yaw, pitch, roll], ...]} in scene "
          "units and radians, or a scene of vkopple generate")
      ->required();
  command
      ->add_option("--frames", o->frames,
                   "Which three of the poses are those of the frames, counted from 0 (default: 0,1,2)")
      ->delimiter(',')
      ->expected(3)
      ->check(CLI::Range(0, 1'000'000));
  command->add_option("--truth", o->truth, "The true third image, to compare with");
  command
      ->add_option("--out", o->out,
                   "Folder for warped.png, imagined.png, predicted.png, weight.png, depth.exr, comparison.png")
      ->required();
  command->add_flag("--json", o->json, "Print JSON");
  add_device_option(*command, o->device);
  command->footer(
      "Examples: vkopple predict run/latest.safetensors 1.png 2.png --poses poses.json --out third\n"
      "          vkopple predict run/latest.safetensors 000000.0.png 000000.2.png --poses 000000.json "
      "--frames 0,2,4\n"
      "                          --truth 000000.4.png --out third");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
