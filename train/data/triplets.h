#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/buffer.h"

namespace vkopple {

/// Where an object truly is in a triplet's middle frame.
struct ObjectTruth {
  std::array<double, 3> location{};  ///< of its middle in the camera's frame: x right, y forward, z up
  uint64_t pixels = 0;               ///< that show it, by their centres; 0: out of sight
  std::optional<double> yaw;         ///< in the camera's frame, counter-clockwise seen from above, radians
};

/// In place of the labels of a triplet of which they are unknown.
inline constexpr uint32_t kUnknownLabel = UINT32_MAX;

/// A batch of triplets of frames. What is unknown of all of them is empty.
struct TripletBatch {
  int batch = 0, height = 0, width = 0;
  std::array<std::vector<float>, 3>
      images;   ///< a frame each: (batch, 3, height, width) red, green, blue in [0, 1]
  Slice drawn;  ///< where images were left on the device, which `images` lacks then: a frame behind the other
  std::array<std::vector<float>, 3>
      poses;  ///< a frame each: (batch, 6) x, y, z, yaw, pitch, roll of the camera; unknown in evaluation only
  std::vector<float> depth;     ///< (batch, height, width) of the middle frame, Euclidean; 0 where unknown
  std::vector<uint32_t> label;  ///< likewise: 0 background, i + 1 object i
  std::vector<std::vector<ObjectTruth>> objects;  ///< of each triplet; none where unknown

  /// Shows triplet `index` backwards in time.
  void reverse(int index);
};

/// Hands out batches of triplets by number. The same step gives the same batch, whatever was asked for before.
class TripletSource {
 public:
  virtual ~TripletSource() = default;
  virtual TripletBatch read(uint64_t step) = 0;
  /// The same batch; truth only by chance.
  virtual TripletBatch read_shown(uint64_t step) { return read(step); }
  /// The same batch as training takes it: triplet i backwards in time where `reversed[i]`, truth and the images
  /// of frames before `first_frame` only by chance. What is drawn may be left on the device, valid until the
  /// next call: frames `first_frame` to 2.
  virtual TripletBatch show(uint64_t step, const std::vector<bool>& reversed, int first_frame);
  /// How many triplets there are before they come again; nothing where they never do.
  virtual std::optional<uint64_t> size() const { return std::nullopt; }
};

/// Every evenly strided triplet of `frames` frames, counted from 0: (0,1,2), (1,2,3), ..., (0,2,4), ...
std::vector<std::array<int, 3>> strided_triplets(int frames);

}  // namespace vkopple
