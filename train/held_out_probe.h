#pragma once

#include <cstdint>
#include <vector>

#include "models/perception.h"
#include "train/image.h"
#include "train/model_store.h"
#include "train/rooms/room_source.h"
#include "train/step_record.h"

namespace vkopple {

/// Tells during training how well single images are seen: in rooms of their own seed, which training never
/// draws, by the networks with their running averages. Changes nothing that training uses.
class HeldOutProbe {
 public:
  static constexpr int kImages = 64;
  static constexpr size_t kShown = 4;

  struct Options {
    int batch = 16;
    uint64_t seed = 0;    ///< of the rooms
    bool objects = true;  ///< false: depth alone, while no network learns objects
  };

  /// Bytes of device memory that a probe takes beside the weights. Needs no device.
  static uint64_t device_bytes(const Caps& caps, const ModelConfig& config, const RoomsConfig& rooms,
                               const Options& options);

  HeldOutProbe(const ModelStore& store, const ModelConfig& config, const RoomsConfig& rooms,
               const Options& options);

  /// The scores of docs/model.md §10, as `vkopple eval` takes them. With `pictures` also the grid of the first
  /// kShown images: picture, inferred objects, true objects, inferred depth, true depth.
  HeldOutScores measure(std::vector<std::vector<RgbImage>>* pictures = nullptr);

 private:
  Perception perception_;
  RoomSource rooms_;
};

}  // namespace vkopple
