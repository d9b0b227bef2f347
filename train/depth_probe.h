#pragma once

#include <cstdint>
#include <optional>

#include "models/perception.h"
#include "train/model_store.h"
#include "train/rooms/room_source.h"

namespace vkopple {

/// Tells during training how well depth is seen: in rooms of their own seed, by the depth network alone with
/// its running averages. Changes nothing that training uses.
class DepthProbe {
 public:
  static constexpr int kImages = 64;

  DepthProbe(const ModelStore& store, const ModelConfig& config, const RoomsConfig& rooms, int batch,
             uint64_t seed);

  /// Correlation of an image's depth with the truth (docs/model.md §10), mean over images; nothing where it is
  /// undefined for all.
  std::optional<double> measure();

 private:
  Perception perception_;
  RoomSource rooms_;
};

}  // namespace vkopple
