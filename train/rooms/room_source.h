#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "train/data/triplets.h"
#include "train/rooms/renderer.h"

namespace vkopple {

/// Triplets of rooms drawn on the device at every step, no two alike: triplet `b` of step `s` shows scene s *
/// batch + b of the seed, in one of its evenly strided triplets of frames.
class RoomSource : public TripletSource {
 public:
  RoomSource(const Device& device, const Lens& lens, const RoomsConfig& rooms, int batch, uint64_t seed);

  /// Draws step's batch; the pixels stay on the device until the next call.
  void render(uint64_t step);
  /// (batch, height, width) pixels of red, green, blue, 0 of frame 0, 1 or 2: a tensor (batch, 3, height,
  /// width) in NC4HW4.
  Slice image(int frame);
  /// (batch, height, width) of the middle frame.
  Slice depth();
  Slice label();
  /// (batch, 6) of frame 0, 1 or 2.
  const std::vector<float>& poses(int frame) const { return poses_.at(static_cast<std::size_t>(frame)); }

  /// Everything of the batch drawn last.
  TripletBatch download();
  /// render() and download().
  TripletBatch read(uint64_t step) override;

 private:
  Slice third(const Slice& whole, int frame) const;
  std::vector<std::vector<ObjectTruth>> truths(const std::vector<uint32_t>& label) const;

  RoomsConfig rooms_;
  int batch_;
  uint64_t seed_;
  RoomRenderer renderer_;
  std::vector<std::array<int, 3>> choices_;  ///< the triplets of a scene
  std::vector<Scene> scenes_;
  std::vector<std::array<int, 3>> frames_;  ///< those shown of each scene
  std::array<std::vector<float>, 3> poses_;
};

}  // namespace vkopple
