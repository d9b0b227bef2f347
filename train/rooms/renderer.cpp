#include "train/rooms/renderer.h"

#include <fmt/format.h>

#include <cmath>

#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/quirks.h"
#include "runtime/transfer.h"
#include "train/rooms/scene_pack.h"

namespace vkopple {
namespace {

/// As the shaders' block.
struct RoomsPush {
  int32_t views, height, width;
  int32_t view_rows;
  float focal;
};

// Pixels of a column that one invocation draws, 32 at most. Many share the cost of the kinds of pixels that
// none of them is of; few make more invocations.
constexpr uint32_t kLinesOnCpu = 32, kLinesOnGpu = 8;

/// Bytes of `views` pictures of 3 floats; throws Error where a shader can't reach so many.
uint64_t image_bytes(const Device& device, const Lens& lens, int views) {
  const uint64_t bytes = lens.pixels() * static_cast<uint64_t>(views) * 3 * sizeof(float),
                 most = device.caps().max_storage_range;
  if (bytes <= most) return bytes;
  throw Error(
      fmt::format("rooms: {} pictures of {} x {} pixels take {} bytes and {} reaches {} at once; draw fewer or "
                  "smaller ones",
                  views, lens.width, lens.height, bytes, device.caps().name, most));
}

/// As shaders/rooms/texture.glsl counts them.
uint32_t textures_constant(RoomTextures textures) {
  switch (textures) {
    case RoomTextures::kPeriodic:
      return 1;
    case RoomTextures::kSmooth:
      return 2;
    case RoomTextures::kMixed:
      return 0;
  }
  return 0;
}

uint64_t scene_bytes(std::size_t objects, int views) {
  return packed_view_size(objects) * static_cast<uint64_t>(views) * sizeof(float);
}

}  // namespace

double Lens::focal() const { return height / (2 * std::tan(fov / 2)); }

double Lens::half_view() const { return std::atan(width / (2 * focal())); }

RoomRenderer::Kernel RoomRenderer::kernel_for(const Caps& caps) {
  return compiles_long_kernels(caps) ? Kernel::kSorted : Kernel::kPlain;
}

RoomRenderer::RoomRenderer(const Device& device, const Lens& lens, const RoomsConfig& rooms, int views,
                           Truth truth, std::optional<Kernel> kernel)
    : device_(&device),
      lens_(lens),
      objects_(static_cast<std::size_t>(rooms.objects)),
      views_(views),
      scene_(device, scene_bytes(objects_, views), MemoryKind::kDevice, "rooms scene"),
      image_(device, image_bytes(device, lens, views), MemoryKind::kDevice, "rooms image") {
  const RoomsPush push{views, lens.height, lens.width, static_cast<int32_t>(packed_view_size(objects_) / 4),
                       static_cast<float>(lens.focal())};
  const bool sorted = kernel.value_or(kernel_for(device.caps())) == Kernel::kSorted;
  const uint32_t lines = sorted && device.caps().cpu() ? kLinesOnCpu : kLinesOnGpu;
  const uint64_t strips = (static_cast<uint64_t>(lens.height) + lines - 1) / lines;
  Recorder recorder(device);
  recorder.dispatch_flat(sorted ? "room_image.sorted" : "room_image.plain",
                         strips * static_cast<uint64_t>(views) * static_cast<uint64_t>(lens.width),
                         {scene_.whole(), image()}, push,
                         {static_cast<uint32_t>(rooms.supersample), textures_constant(rooms.textures), lines});
  if (truth == Truth::kDrawn) {
    depth_.emplace(device, pixels() * sizeof(float), MemoryKind::kDevice, "rooms depth");
    label_.emplace(device, pixels() * sizeof(uint32_t), MemoryKind::kDevice, "rooms label");
    recorder.dispatch_flat("room_truth", pixels(), {scene_.whole(), depth(), label()}, push);
  }
  commands_ = recorder.finish();
}

uint64_t RoomRenderer::device_bytes(const Lens& lens, const RoomsConfig& rooms, int views, Truth truth) {
  // Red, green and blue, and where truth is drawn depth and label.
  const uint64_t words = lens.pixels() * static_cast<uint64_t>(views) * (truth == Truth::kDrawn ? 5 : 3);
  return scene_bytes(static_cast<std::size_t>(rooms.objects), views) + words * sizeof(float);
}

void RoomRenderer::render(const std::vector<View>& views) {
  if (views.size() != static_cast<std::size_t>(views_)) {
    throw Error(fmt::format("rooms: {} views to draw where {} were announced", views.size(), views_));
  }
  std::vector<float> packed;
  packed.reserve(packed_view_size(objects_) * views.size());
  for (const View& view : views) {
    if (view.scene->objects.size() != objects_) {
      throw Error(fmt::format("rooms: a scene of {} objects where {} were announced",
                              view.scene->objects.size(), objects_));
    }
    pack_view(*view.scene, view.frame, packed);
  }
  upload_values<float>(*device_, scene_.whole(), packed);
  commands_->run();
}

}  // namespace vkopple
