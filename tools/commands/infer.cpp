#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "models/identities.h"
#include "models/perception.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/objects_text.h"
#include "tools/output_folder.h"
#include "tools/precision_option.h"
#include "train/atomic_file.h"
#include "train/checkpoint.h"
#include "train/count_progress.h"
#include "train/image_files.h"
#include "train/image_frames.h"
#include "train/image_io.h"
#include "train/interrupt.h"
#include "train/pictures.h"
#include "train/seen_image.h"
#include "train/trained_networks.h"
#include "train/tuning_file.h"

namespace vkopple {
namespace {

constexpr size_t kGridRows = 16;

struct Options {
  std::string model;
  std::vector<std::string> images;
  std::string out;
  std::string grid;
  bool sequence = false;
  bool json = false;
  Precision precision = Precision::kFloat32;
  std::string device;
  KernelFamily kernels = KernelFamily::kAuto;
};

Plane<uint8_t> bytes_of(const Plane<uint32_t>& plane) {
  Plane<uint8_t> out(plane.height, plane.width);
  for (size_t i = 0; i < plane.pixels.size(); ++i) out.pixels[i] = static_cast<uint8_t>(plane.pixels[i]);
  return out;
}

using Ids = std::vector<std::optional<size_t>>;

/// Frames of one camera in the order of time.
struct Recording {
  Identities identities;
  uint64_t frames = 0;  ///< seen so far

  Ids follow(const SeenImage& seen) {
    std::vector<float> codes;
    std::vector<bool> visible;
    for (const SeenObject& object : seen.objects) {
      codes.insert(codes.end(), object.identity.begin(), object.identity.end());
      visible.push_back(object.share > 0);
    }
    ++frames;
    return identities.follow(codes, visible);
  }
};

/// Objects in the colours of their slots or, in a recording, of their identities.
RgbImage tinted(const RgbImage& image, const SeenImage& seen, const Ids& ids, int zoom = 1) {
  constexpr int32_t kBackground = -1;
  std::vector<int32_t> labels;
  for (const uint32_t slot : seen.mask.pixels)
    labels.push_back(slot == seen.background ? kBackground
                                             : static_cast<int32_t>(ids.empty() ? slot : ids.at(slot).value()));
  return overlay(image, labels, kBackground, zoom);
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

  /// What the results of a file are called.
  std::string name_for(const std::string& path) { return folder_.name_for(path); }
  /// Likewise of one of its frames.
  std::string name_for(const std::string& file_name, uint64_t frame) {
    return folder_.unique_name(fmt::format("{}.{:06}", file_name, frame));
  }

  Recording new_recording() const { return {.identities = Identities(static_cast<size_t>(config_.identity))}; }

  /// Writes what is seen; the JSON comes last, so that where it lies all is complete. `recording`: which the
  /// image is the next frame of, or null. Gives what is to be printed.
  std::string show(const std::string& path, const std::string& name, const RgbImage& image,
                   Recording* recording) {
    const RgbImage small = resize(image, config_.height, config_.width);
    const SeenImage seen_small = see_image(perception_, small);
    const SeenImage seen = resize(seen_small, image.height, image.width);
    const Ids ids = recording == nullptr ? Ids{} : recording->follow(seen_small);
    write_png(folder_ / (name + ".mask.png"), bytes_of(seen.mask));
    write_png(folder_ / (name + ".overlay.png"), tinted(image, seen, ids));
    write_depth_exr(folder_ / (name + ".depth.exr"), seen.depth);
    nlohmann::ordered_json json{{"image", path}, {"name", name}};
    if (recording != nullptr) json["frame"] = recording->frames - 1;
    json.update(to_json(seen));
    for (size_t k = 0; k < ids.size(); ++k) json["objects"][k]["id"] = id_json(ids[k]);
    write_file(folder_ / (name + ".json"), json.dump(2) + "\n");
    if (options_.json) all_.push_back(std::move(json));
    if (!options_.grid.empty() && grid_.size() < kGridRows) add_row(small, seen_small, ids);
    return options_.json ? std::string() : text(name, seen, ids);
  }

  void finish() const {
    if (options_.json) fmt::print("{}\n", all_.dump(2));
    if (grid_.empty()) return;
    write_png(options_.grid, picture_grid(grid_));
    fmt::print(stderr, "{}: image, depth{}\n", options_.grid, objects_ ? ", objects" : "");
  }

 private:
  /// Pictures of one size, whatever size the images have.
  void add_row(const RgbImage& small, const SeenImage& seen, const Ids& ids) {
    const int zoom = zoom_for(small.height);
    const auto farthest = static_cast<float>(config_.max_depth);
    grid_.push_back({enlarge(small, zoom), enlarge(depth_picture(seen.depth, farthest), zoom)});
    if (objects_) grid_.back().push_back(tinted(small, seen, ids, zoom));
  }

  static nlohmann::ordered_json id_json(const std::optional<size_t>& id) {
    return id ? nlohmann::ordered_json(*id) : nlohmann::ordered_json(nullptr);
  }

  static std::string text(const std::string& name, const SeenImage& seen, const Ids& ids) {
    const auto [nearest, farthest] = std::minmax_element(seen.depth.pixels.begin(), seen.depth.pixels.end());
    return fmt::format("{}: depth from {:.2f} to {:.2f}\n", name, *nearest, *farthest) +
           objects_text(seen.objects, ids);
  }

  const Options& options_;
  ModelConfig config_;
  OutputFolder folder_;
  bool objects_;
  Perception perception_;
  nlohmann::ordered_json all_ = nlohmann::ordered_json::array();
  std::vector<std::vector<RgbImage>> grid_;
};

/// Reads what was named and shows it to the model. What can't be read is told of, and the rest is done.
class Viewing {
 public:
  Viewing(const Options& o, Inference& inference) : options_(o), inference_(inference), progress_("images", 0) {
    if (o.sequence) whole_ = inference.new_recording();
    for (const std::string& image : o.images)
      if (const auto files = attempt([&] { return image_files(image); }))
        files_.insert(files_.end(), files->begin(), files->end());
    total_ = files_.size();
    progress_.set_total(*total_);
  }

  void see_all() {
    for (const auto& file : files_) see(file);
  }
  bool all_read() const { return all_read_; }

 private:
  /// What `read` gives; nothing where it fails, which is said.
  template <class Read>
  auto attempt(const Read& read) -> std::optional<decltype(read())> {
    try {
      return read();
    } catch (const Error& error) {
      progress_.clear();
      fmt::print(stderr, "vkopple: {}\n", error.what());
      all_read_ = false;
      return std::nullopt;
    }
  }

  void see(const std::string& path) {
    stop_if_asked();
    const auto opened = attempt([&] { return std::make_unique<ImageFrames>(path); });
    if (!opened) return;
    ImageFrames& frames = **opened;
    const std::string name = inference_.name_for(path);
    if (!frames.film()) return show(path, name, *frames.next(), whole_);
    expect(frames.count());
    std::optional<Recording> own;
    if (!whole_) own = inference_.new_recording();
    for (uint64_t i = 0;; ++i) {
      const auto image = attempt([&] { return frames.next(); });
      if (!image || !*image) return;
      show(path, inference_.name_for(name, i), **image, whole_ ? whole_ : own);
      stop_if_asked();
    }
  }

  void show(const std::string& path, const std::string& name, const RgbImage& image,
            std::optional<Recording>& recording) {
    const std::string text = inference_.show(path, name, image, recording ? &*recording : nullptr);
    if (!text.empty()) progress_.clear();
    fmt::print("{}", text);
    progress_.show(++shown_);
  }

  /// A film takes the place of one picture.
  void expect(const std::optional<uint64_t>& frames) {
    total_ = total_ && frames ? std::optional(*total_ - 1 + *frames) : std::nullopt;
    progress_.set_total(total_.value_or(0));
  }

  void stop_if_asked() const {
    if (interrupt_.requested())
      throw Error(fmt::format("{}: stopped after {} images; their files are complete", options_.out, shown_));
  }

  const Options& options_;
  Inference& inference_;
  const Interrupt interrupt_;
  CountProgress progress_;
  std::optional<Recording> whole_;  ///< where all images are frames of one
  std::vector<std::filesystem::path> files_;
  std::optional<uint64_t> total_;  ///< of images, where it is known
  uint64_t shown_ = 0;
  bool all_read_ = true;
};

void run(const Options& o) {
  require_kernels_suit(o.kernels, o.precision);
  const Device device({.selector = o.device, .kernels = o.kernels, .tuned = load_tuned_choices});
  const LoadedModel model = load_model(device, o.model);
  Inference inference(o, device, model);
  bool all_read = true;
  {
    Viewing viewing(o, inference);
    viewing.see_all();
    all_read = viewing.all_read();
  }
  inference.finish();
  if (!all_read) throw CLI::RuntimeError(1);
}

}  // namespace

void add_infer(CLI::App& app) {
  CLI::App* command = app.add_subcommand("infer", "Cut images into objects, with depth");
  const auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "A checkpoint, or the folder of a run")->required();
  command
      ->add_option(
          "image", o->images,
          "Images of any size (PNG, JPEG, TIFF, EXR, WebP and others), folders of such, animations and videos")
      ->required();
  command
      ->add_option("--out", o->out,
                   "Folder for NAME.mask.png, NAME.overlay.png, NAME.depth.exr and NAME.json of every image")
      ->required();
  command->add_option("--grid", o->grid,
                      fmt::format("Write the first {} images with overlay and depth as a PNG", kGridRows));
  command->add_flag(
      "--sequence", o->sequence,
      "All images are frames of one recording, in the order given, those of a folder by the numbers "
      "in their names; an object keeps its id and colour. Animations, videos and pages of a TIFF are "
      "recordings anyway, each on its own");
  command->add_flag("--json", o->json, "Print JSON");
  add_precision_option(*command, o->precision, "float32");
  add_device_option(*command, o->device);
  add_kernels_option(*command, o->kernels);
  command->footer(
      "Examples: vkopple infer run/latest.safetensors photo.jpg room.png --out seen\n"
      "          vkopple infer run --sequence frames --out seen\n"
      "          vkopple infer run film.gif --out seen --grid film.png");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
