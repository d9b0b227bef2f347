#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string_view>

#include "models/strict_json.h"

namespace vkopple {

/// How the predicted pose is held against the seen one: half the sum of both Kullback–Leibler divergences, or
/// Jensen–Shannon.
enum class PoseLossKind { kKl, kJs };
inline constexpr std::array<std::string_view, 2> kPoseLossNames{"kl", "js"};

/// Which frames pass the depth network and the mask decoder in a training step (docs/model.md §6): all, for
/// their part in batch norm's running averages, or the second alone, whose depth and masks the losses read.
enum class StatisticsFrames { kAll, kSecond };
inline constexpr std::array<std::string_view, 2> kStatisticsFramesNames{"all", "second"};

/// Over what the mask decoder's batch norms take their statistics (docs/model.md §2.2): each slot's pass has
/// its own, or all slots of a frame have them together.
enum class MaskStatistics { kApart, kTogether };
inline constexpr std::array<std::string_view, 2> kMaskStatisticsNames{"apart", "together"};

/// What the slots say of an object's orientation (docs/model.md §8): a distribution over yaw, or three Euler
/// angles.
enum class Orientation { kYaw, kEuler };
inline constexpr std::array<std::string_view, 2> kOrientationNames{"yaw", "euler"};
/// Numbers of a slot for the angles' cosines and sines.
inline constexpr int kEulerNumbers = 6;

/// Whose masks, with the background's, pictures of 8 bits can number.
inline constexpr int kMostSlots = 254;

/// Pixels on a side of the model's images, least and most.
inline constexpr int kSmallestImage = 4, kLargestImage = 4096;

/// What fixes the model's shapes and formulas. The defaults are the published model's. Angles in radians,
/// lengths in scene units.
struct ModelConfig {
  int height = 128;
  int width = 128;
  double fov = std::numbers::pi / 2;  ///< vertical
  int slots = 3;                      ///< objects beside the background
  int bins = 120;                     ///< of an object's yaw
  int identity = 10;                  ///< leading components of the code by which objects are matched
  int code = 64;
  int depth_width = 16;  ///< channels of the depth network's first convolution; the others scale with it
  int object_width = 64;
  int imagine_width = 8;
  int lstm = 256;
  int slot_counters =
      0;  ///< hidden units of the LSTM that count its steps from the start; see models/slot_counters.h
  double max_depth = 7.2;
  double max_height = 5.0;
  double beta = 1.0;  ///< how fast the splat's weight falls with distance
  double mask_window =
      0;  ///< radius r within which masks stay around their slot's location, scene units; 0: none
  bool mask_location = false;  ///< true: an object is at its mask's centroid, and moves as that does
  double reg = 1.0;            ///< factor of the regularising losses
  double smoothness = 0;       ///< of the masks' spatial smoothness among them
  double pose_contrast = 0;    ///< of the contrast of poses among them; of yaw alone
  double slot_contrast = 0;    ///< of the contrast of the slots' places among them
  bool warp = true;            ///< false: only the imagined image is used (an ablation)
  bool relaxed = false;        ///< true: learned motion; of yaw alone
  Orientation orientation = Orientation::kYaw;
  PoseLossKind pose_loss = PoseLossKind::kKl;
  StatisticsFrames statistics_frames = StatisticsFrames::kAll;
  MaskStatistics mask_statistics = MaskStatistics::kApart;
  std::array<double, 3> dropout{0.05, 0.05, 0.0005};  ///< depth, object, imagination network

  bool operator==(const ModelConfig&) const = default;

  /// Numbers of a slot that tell its orientation.
  int orientation_numbers() const { return orientation == Orientation::kYaw ? bins : kEulerNumbers; }

  /// A model configuration alone, as a fixture's metadata has it. Throws Error naming origin and key.
  static ModelConfig parse(std::string_view json, std::string_view origin);
};

/// Reads the object's members over the defaults; throws Error naming file and key.
ModelConfig read_model_config(JsonObject object);
nlohmann::ordered_json write_model_config(const ModelConfig& config);

}  // namespace vkopple
