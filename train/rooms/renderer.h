#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "models/model_config.h"
#include "runtime/buffer.h"
#include "runtime/caps.h"
#include "runtime/recorder.h"
#include "train/rooms/scene.h"

namespace vkopple {

class Device;

/// Size and angle of view of the pictures.
struct Lens {
  int height = 0;
  int width = 0;
  double fov = 0;  ///< vertical, radians

  explicit Lens(const ModelConfig& model) : Lens(model.height, model.width, model.fov) {}
  Lens(int height_pixels, int width_pixels, double vertical)
      : height(height_pixels), width(width_pixels), fov(vertical) {}
  double focal() const;      ///< pixels
  double half_view() const;  ///< half the horizontal angle of view
  uint64_t pixels() const { return static_cast<uint64_t>(height) * static_cast<uint64_t>(width); }
};

/// One frame of one scene.
struct View {
  const Scene* scene = nullptr;
  int frame = 0;
};

/// Draws views of rooms on the device; pixels stay there until asked for. Made for a number of views, drawn any
/// number of times.
class RoomRenderer {
 public:
  enum class Truth { kDrawn, kLeftOut };
  /// The kernel that draws: its pictures are the same but for rounding.
  enum class Kernel {
    kSorted,  ///< takes pixels by what they show
    kPlain,   ///< a fifth of the code, slower
  };
  /// The one that a device can compile, and is faster with.
  static Kernel kernel_for(const Caps& caps);

  /// Every scene drawn must have as many objects as `rooms`, and textures as it has them. Throws Error where
  /// the device's memory is too small. `kernel`: kernel_for the device where there is none.
  RoomRenderer(const Device& device, const Lens& lens, const RoomsConfig& rooms, int views,
               Truth truth = Truth::kDrawn, std::optional<Kernel> kernel = {});

  /// Bytes of device memory that such a renderer takes.
  static uint64_t device_bytes(const Lens& lens, const RoomsConfig& rooms, int views, Truth truth);

  /// Draws `views`, as many as this was made for, and waits.
  void render(const std::vector<View>& views);

  /// (views, 3, height, width) floats: red, green and blue in [0, 1].
  Slice image() { return image_.whole(); }
  /// (views, height, width) floats: Euclidean distance along the ray through the pixel's centre. Truth must be
  /// drawn.
  Slice depth() { return depth_.value().whole(); }
  /// (views, height, width) uint32: 0 background, i + 1 object i, at the pixel's centre. Truth must be drawn.
  Slice label() { return label_.value().whole(); }

  const Device& device() const { return *device_; }
  const Lens& lens() const { return lens_; }
  int views() const { return views_; }

 private:
  uint64_t pixels() const { return static_cast<uint64_t>(views_) * lens_.pixels(); }

  const Device* device_;
  Lens lens_;
  std::size_t objects_;
  int views_;
  Buffer scene_, image_;
  std::optional<Buffer> depth_, label_;
  std::unique_ptr<Commands> commands_;
};

}  // namespace vkopple
