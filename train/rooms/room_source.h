#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "train/data/triplets.h"
#include "train/rooms/renderer.h"

namespace vkopple {

/// A scene and which of its frames are a triplet.
struct RoomTriplet {
  Scene scene;
  std::array<int, 3> frames;
};

/// Triplets of rooms drawn on the device at every step, no two alike: triplet `b` of step `s` shows scene s *
/// batch + b of the seed, in one of its evenly strided triplets of frames.
class RoomSource : public TripletSource {
 public:
  RoomSource(const Device& device, const Lens& lens, const RoomsConfig& rooms, int batch, uint64_t seed);

  /// Bytes of device memory that batches take which are read, or shown.
  static uint64_t read_bytes(const Lens& lens, const RoomsConfig& rooms, int batch);
  static uint64_t show_bytes(const Lens& lens, const RoomsConfig& rooms, int batch, int first_frame);

  /// Everything, on the host.
  TripletBatch read(uint64_t step) override;
  /// No truth, no frames before `first_frame`; the images stay on the device.
  TripletBatch show(uint64_t step, const std::vector<bool>& reversed, int first_frame) override;
  /// What `read` draws.
  std::vector<RoomTriplet> scenes(uint64_t step) const;

 private:
  TripletBatch draw(const std::vector<RoomTriplet>& shown, int first_frame, RoomRenderer& renderer) const;

  const Device* device_;
  Lens lens_;
  RoomsConfig rooms_;
  int batch_;
  uint64_t seed_;
  std::vector<std::array<int, 3>> choices_;  ///< the triplets of a scene
  /// Made when they are needed.
  std::optional<RoomRenderer> whole_, training_;
};

}  // namespace vkopple
