#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "models/perception.h"
#include "train/image.h"

namespace vkopple {

/// What one slot of the model says of an object. Camera frame: x right, y forward, z up.
struct SeenObject {
  std::array<double, 3> location{};               ///< scene units
  double angle = 0;                               ///< atan2(x, y), radians: to the right of straight ahead
  double distance = 0;                            ///< √(x² + y²), scene units
  double yaw = 0;                                 ///< middle of the most likely bin, radians from 0 to 2π
  double yaw_probability = 0;                     ///< of that bin
  std::vector<double> pose;                       ///< probability of every bin of yaw
  std::optional<std::array<double, 9>> rotation;  ///< instead of a yaw: object to camera, row by row
  std::vector<float> identity;                    ///< numbers by which models/identities.h tells who it is
  double share = 0;                               ///< of the picture's pixels, from 0 to 1
};

/// What the model sees in a picture.
struct SeenImage {
  Plane<std::uint32_t> mask;  ///< index of the slot with the largest mask; the background's is their number
  Plane<float> depth;         ///< Euclidean distance, scene units
  std::vector<SeenObject>
      objects;                   ///< by slot, those without a pixel as well; none from a model of depth alone
  std::uint32_t background = 0;  ///< index: the model's number of slots
  std::vector<float>
      soft_masks;  ///< (slots + 1, H, W) of the model's size, the background's last; adding up to 1
};

/// `image` has the model's size, the model a batch of 1. Throws Error where what comes out is no
/// number.
SeenImage see_image(Perception& model, const RgbImage& image);

/// To the size of a picture that was made smaller for the model: indices by the nearest pixel, depth linearly.
SeenImage resize(const SeenImage& seen, int height, int width);

/// The background's share of the mask's pixels, from 0 to 1.
double background_share(const SeenImage& seen);

/// Sizes, the background's index and share, and every slot's object, keyed like the members above.
nlohmann::ordered_json to_json(const SeenImage& seen);

}  // namespace vkopple
