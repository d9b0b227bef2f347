#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "train/data/triplets.h"
#include "train/rooms/renderer.h"

namespace vkopple {

/// Triplets of rooms drawn on the device at every step, no two alike: triplet `b` of step `s` shows scene s *
/// batch + b of the seed, in one of its evenly strided triplets of frames.
class RoomSource : public TripletSource {
 public:
  RoomSource(const Device& device, const Lens& lens, const RoomsConfig& rooms, int batch, uint64_t seed);

  /// Everything, on the host.
  TripletBatch read(uint64_t step) override;
  /// No truth, no frames before `first_frame`; the images stay on the device.
  TripletBatch show(uint64_t step, const std::vector<bool>& reversed, int first_frame) override;

 private:
  using Frames = std::array<int, 3>;
  struct Shown {
    Scene scene;
    Frames frames;
  };

  std::vector<Shown> choose(uint64_t step) const;
  TripletBatch draw(const std::vector<Shown>& shown, int first_frame, RoomRenderer& renderer) const;

  const Device* device_;
  Lens lens_;
  RoomsConfig rooms_;
  int batch_;
  uint64_t seed_;
  std::vector<Frames> choices_;  ///< the triplets of a scene
  /// Made when they are needed.
  std::optional<RoomRenderer> whole_, training_;
};

}  // namespace vkopple
