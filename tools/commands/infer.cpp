#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "models/camera.h"
#include "models/perception.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/output_folder.h"
#include "tools/precision_option.h"
#include "train/trained_networks.h"
#include "train/atomic_file.h"
#include "train/checkpoint.h"
#include "train/count_progress.h"
#include "train/image_io.h"
#include "train/interrupt.h"
#include "train/pictures.h"
#include "train/seen_image.h"
#include "train/tuning_file.h"

namespace vkopple {
namespace {

constexpr size_t kGridRows = 16;

struct Options {
  std::string model;
  std::vector<std::string> images;
  std::string out;
  std::string grid;
  bool json = false;
  Precision precision = Precision::kFloat32;
  std::string device;
  KernelFamily kernels = KernelFamily::kAuto;
};

template <class T>
Plane<T> converted(const Plane<uint32_t>& plane) {
  Plane<T> out(plane.height, plane.width);
  for (size_t i = 0; i < plane.pixels.size(); ++i) out.pixels[i] = static_cast<T>(plane.pixels[i]);
  return out;
}

RgbImage tinted(const RgbImage& image, const SeenImage& seen, int zoom = 1) {
  return overlay(image, converted<int32_t>(seen.mask).pixels, static_cast<int32_t>(seen.background), zoom);
}

/// Shows images to the model one after another.
class Inference {
 public:
  Inference(const Options& o, const Device& device, const LoadedModel& model)
      : options_(o),
        config_(model.config.model),
        folder_(o.out),
        objects_(has_learned(model, Network::kObject)),
        perception_(device, config_, model.store->groups(),
                    {.batch = 1, .objects = objects_, .precision = o.precision}) {
    if (objects_) return;
    spdlog::warn("the object network has not learned yet at step {}: everything is taken for background",
                 model.position.step);
  }

  /// Writes what is seen; the JSON comes last, so that where it lies all is complete.
  void show(const std::string& path, const RgbImage& image) {
    const std::string name = folder_.name_for(path);
    const RgbImage small = resize(image, config_.height, config_.width);
    const SeenImage seen_small = see_image(perception_, small);
    const SeenImage seen = resize(seen_small, image.height, image.width);
    write_png(folder_ / (name + ".mask.png"), converted<uint8_t>(seen.mask));
    write_png(folder_ / (name + ".overlay.png"), tinted(image, seen));
    write_depth_exr(folder_ / (name + ".depth.exr"), seen.depth);
    nlohmann::ordered_json json{{"image", path}, {"name", name}};
    json.update(to_json(seen));
    write_file(folder_ / (name + ".json"), json.dump(2) + "\n");
    if (!options_.json) print(name, seen);
    all_.push_back(std::move(json));
    if (!options_.grid.empty() && grid_.size() < kGridRows) add_row(small, seen_small);
  }

  void finish() const {
    if (options_.json) fmt::print("{}\n", all_.dump(2));
    if (grid_.empty()) return;
    write_png(options_.grid, picture_grid(grid_));
    fmt::print(stderr, "{}: image, depth{}\n", options_.grid, objects_ ? ", objects" : "");
  }

 private:
  /// Pictures of one size, whatever size the images have.
  void add_row(const RgbImage& small, const SeenImage& seen) {
    const int zoom = zoom_for(small.height);
    const auto farthest = static_cast<float>(config_.max_depth);
    grid_.push_back({enlarge(small, zoom), enlarge(depth_picture(seen.depth, farthest), zoom)});
    if (objects_) grid_.back().push_back(tinted(small, seen, zoom));
  }

  static void print(const std::string& name, const SeenImage& seen) {
    const auto [nearest, farthest] = std::minmax_element(seen.depth.pixels.begin(), seen.depth.pixels.end());
    fmt::print("{}: depth from {:.2f} to {:.2f}\n", name, *nearest, *farthest);
    if (!seen.objects.empty())
      fmt::print("  slot   share      x      y      z  angle  distance    yaw {}\n",
                 seen.objects[0].rotation ? " pitch   roll" : "(probability)");
    for (size_t k = 0; k < seen.objects.size(); ++k) {
      const SeenObject& o = seen.objects[k];
      fmt::print("  {:>4} {:>6.1f}% {:>6.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>9.2f} {}\n", k, 100 * o.share,
                 o.location[0], o.location[1], o.location[2], o.angle, o.distance, orientation_text(o));
    }
  }

  static std::string orientation_text(const SeenObject& o) {
    if (!o.rotation) return fmt::format("{:>6.2f} ({:.2f})", o.yaw, o.yaw_probability);
    const auto angles = euler_angles(*o.rotation);
    return fmt::format("{:>6.2f} {:>6.2f} {:>6.2f}", angles[0], angles[1], angles[2]);
  }

  const Options& options_;
  ModelConfig config_;
  OutputFolder folder_;
  bool objects_;
  Perception perception_;
  nlohmann::ordered_json all_ = nlohmann::ordered_json::array();
  std::vector<std::vector<RgbImage>> grid_;
};

/// Nothing where the image can't be read, which is said.
std::optional<RgbImage> try_to_read(const std::string& path, CountProgress& progress) {
  try {
    return read_rgb(path);
  } catch (const Error& error) {
    progress.clear();
    fmt::print(stderr, "vkopple: {}\n", error.what());
    return std::nullopt;
  }
}

void run(const Options& o) {
  require_kernels_suit(o.kernels, o.precision);
  const Device device({.selector = o.device, .kernels = o.kernels, .tuned = load_tuned_choices});
  const LoadedModel model = load_model(device, o.model);
  Inference inference(o, device, model);
  const Interrupt interrupt;
  CountProgress progress("images", o.images.size());
  size_t unread = 0;
  for (size_t i = 0; i < o.images.size(); ++i) {
    if (interrupt.requested())
      throw Error(fmt::format("{}: stopped after {} of {} images; their files are complete", o.out, i,
                              o.images.size()));
    const auto image = try_to_read(o.images[i], progress);
    if (image)
      inference.show(o.images[i], *image);
    else
      ++unread;
    progress.show(i + 1);
  }
  progress.clear();
  inference.finish();
  if (unread > 0) throw CLI::RuntimeError(1);
}

}  // namespace

void add_infer(CLI::App& app) {
  CLI::App* command = app.add_subcommand("infer", "Cut images into objects, with depth");
  const auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "A checkpoint, or the folder of a run")->required();
  command->add_option("image", o->images, "Images of any size and format that OpenImageIO reads")->required();
  command
      ->add_option("--out", o->out,
                   "Folder for NAME.mask.png, NAME.overlay.png, NAME.depth.exr and NAME.json of every image")
      ->required();
  command->add_option("--grid", o->grid,
                      fmt::format("Write the first {} images with overlay and depth as a PNG", kGridRows));
  command->add_flag("--json", o->json, "Print JSON");
  add_precision_option(*command, o->precision, "float32");
  add_device_option(*command, o->device);
  add_kernels_option(*command, o->kernels);
  command->footer("Example: vkopple infer run/latest.safetensors photo.jpg room.png --out seen");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
