#include "capi/vkopple.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "capi/boundary.h"
#include "capi/growing_struct.h"
#include "capi/read_image.h"
#include "models/perception.h"
#include "runtime/device.h"
#include "train/checkpoint.h"
#include "train/seen_image.h"
#include "train/trained_networks.h"
#include "train/tuning_file.h"

using vkopple::capi::guarded;

struct vkopple_model {
  vkopple_model(const char* path, const vkopple_options& options)
      : device({.selector = options.device == nullptr ? "" : options.device,
                .tuned = vkopple::load_tuned_choices}),
        loaded(vkopple::load_model(device, path)),
        objects(vkopple::has_learned(loaded, vkopple::Network::kObject)),
        perception(device, loaded.config.model, loaded.store->groups(),
                   {.batch = 1,
                    .objects = objects,
                    .precision = options.precision == VKOPPLE_MIXED ? vkopple::Precision::kMixed
                                                                    : vkopple::Precision::kFloat32}) {}

  vkopple::Device device;
  vkopple::LoadedModel loaded;
  bool objects;
  vkopple::Perception perception;
};

struct vkopple_seen {
  vkopple::SeenImage image;
  std::vector<vkopple_object> objects;
  double background_share = 0;
  int32_t model_height = 0, model_width = 0;
};

namespace {

void require_pointer(const void* pointer, const char* name) {
  if (pointer == nullptr) throw vkopple::UsageError(fmt::format("{} is a null pointer", name));
}

// Sizes for growing_struct.h. A member that is added begins behind what was the structure's sizeof: what was
// padding there holds anything in a caller of before.
constexpr size_t kFirstOptions = offsetof(vkopple_options, precision) + sizeof(int32_t);
constexpr size_t kFirstModelInfo = offsetof(vkopple_model_info, step) + sizeof(uint64_t);

vkopple_options checked(const vkopple_options* given) {
  constexpr vkopple_options kStandard{sizeof(vkopple_options), nullptr, VKOPPLE_FLOAT32};
  if (given == nullptr) return kStandard;
  const vkopple_options options =
      vkopple::capi::read_struct(given, kStandard, kFirstOptions, "vkopple_options");
  const int32_t precision = options.precision;
  if (precision != VKOPPLE_FLOAT32 && precision != VKOPPLE_MIXED)
    throw vkopple::UsageError(
        fmt::format("the precision is {}; it must be VKOPPLE_FLOAT32 or VKOPPLE_MIXED", precision));
  return options;
}

vkopple_object as_object(const vkopple::SeenObject& o) {
  return {
      {o.location[0], o.location[1], o.location[2]}, o.angle, o.distance, o.yaw, o.yaw_probability, o.share};
}

/// Null where there is no such object.
const vkopple::SeenObject* find_object(const vkopple_seen* seen, size_t object) {
  const auto& objects = seen->image.objects;
  return object < objects.size() ? &objects[object] : nullptr;
}

template <class T>
void store(T* where, T value) {
  if (where != nullptr) *where = value;
}

}  // namespace

const char* vkopple_version(void) { return VKOPPLE_VERSION; }

const char* vkopple_last_error(void) { return vkopple::capi::last_error().c_str(); }

vkopple_status vkopple_load(const char* path, const vkopple_options* options, vkopple_model** model) {
  if (model != nullptr) *model = nullptr;
  return guarded([&] {
    require_pointer(path, "path");
    require_pointer(model, "model");
    *model = std::make_unique<vkopple_model>(path, checked(options)).release();
  });
}

void vkopple_free(vkopple_model* model) { delete model; }

vkopple_status vkopple_get_model_info(const vkopple_model* model, vkopple_model_info* info) {
  return guarded([&] {
    require_pointer(model, "model");
    require_pointer(info, "info");
    const vkopple::ModelConfig& config = model->loaded.config.model;
    const bool tells_yaws = config.orientation == vkopple::Orientation::kYaw;
    const vkopple_model_info told{
        sizeof(vkopple_model_info),   config.height,          config.width, config.slots,
        tells_yaws ? config.bins : 0, model->objects ? 1 : 0, config.fov,   config.max_depth,
        model->loaded.position.step};
    vkopple::capi::write_struct(info, told, kFirstModelInfo, "vkopple_model_info");
  });
}

vkopple_status vkopple_see(vkopple_model* model, const vkopple_image* image, vkopple_seen** seen) {
  if (seen != nullptr) *seen = nullptr;
  return guarded([&] {
    require_pointer(model, "model");
    require_pointer(image, "image");
    require_pointer(seen, "seen");
    const vkopple::RgbImage whole = vkopple::capi::read_image(*image);
    const vkopple::ModelConfig& config = model->perception.config();
    const auto small =
        vkopple::see_image(model->perception, vkopple::resize(whole, config.height, config.width));
    auto result = std::make_unique<vkopple_seen>();
    result->image = vkopple::resize(small, whole.height, whole.width);
    for (const vkopple::SeenObject& object : result->image.objects)
      result->objects.push_back(as_object(object));
    result->background_share = vkopple::background_share(result->image);
    result->model_height = config.height;
    result->model_width = config.width;
    *seen = result.release();
  });
}

void vkopple_seen_free(vkopple_seen* seen) { delete seen; }

void vkopple_seen_size(const vkopple_seen* seen, int32_t* height, int32_t* width) {
  store(height, int32_t{seen->image.mask.height});
  store(width, int32_t{seen->image.mask.width});
}

const uint32_t* vkopple_seen_mask(const vkopple_seen* seen) { return seen->image.mask.pixels.data(); }

const float* vkopple_seen_depth(const vkopple_seen* seen) { return seen->image.depth.pixels.data(); }

uint32_t vkopple_seen_background(const vkopple_seen* seen, double* share) {
  store(share, seen->background_share);
  return seen->image.background;
}

const vkopple_object* vkopple_seen_objects(const vkopple_seen* seen, size_t* count) {
  store(count, seen->objects.size());
  return seen->objects.empty() ? nullptr : seen->objects.data();
}

const double* vkopple_seen_pose(const vkopple_seen* seen, size_t object, size_t* bins) {
  const vkopple::SeenObject* seen_object = find_object(seen, object);
  const bool there = seen_object != nullptr && !seen_object->pose.empty();
  store(bins, there ? seen_object->pose.size() : size_t{0});
  return there ? seen_object->pose.data() : nullptr;
}

const double* vkopple_seen_rotation(const vkopple_seen* seen, size_t object) {
  const vkopple::SeenObject* seen_object = find_object(seen, object);
  return seen_object != nullptr && seen_object->rotation ? seen_object->rotation->data() : nullptr;
}

const float* vkopple_seen_soft_masks(const vkopple_seen* seen, size_t* planes, int32_t* height,
                                     int32_t* width) {
  const bool there = !seen->image.soft_masks.empty();
  store(planes, there ? size_t{seen->image.background} + 1 : size_t{0});
  store(height, seen->model_height);
  store(width, seen->model_width);
  return there ? seen->image.soft_masks.data() : nullptr;
}
