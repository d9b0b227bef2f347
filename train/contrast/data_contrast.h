#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "train/contrast/known_triplet.h"
#include "train/json_io.h"
#include "train/rooms/renderer.h"

namespace vkopple {

/// Image losses (docs/model.md §6: sums over colours and pixels, means over triplets) of three predictions.
struct PredictionLosses {
  double ideal = 0;  ///< with true masks, depth and motion
  double flat = 0;   ///< with the image's mean depth at every pixel
  double still = 0;  ///< with the camera's motion alone
};

/// How much of the image loss there is to win by depth, and by knowing that objects move, on data of which
/// everything is known: what the model's warp (docs/model.md §5) predicts with the truth, and with less of it.
class DataContrast {
 public:
  /// beta: of the warp.
  DataContrast(const Lens& lens, double beta) : lens_(lens), beta_(beta) {}

  /// Throws Error where sizes don't fit, or a label has no motion.
  void add(const KnownTriplet& triplet);

  std::int64_t triplets() const { return triplets_; }
  /// As the stage of depth alone has it (§7): what nothing lands on is filled from the frame before. 0 without
  /// triplets, as all that follows.
  PredictionLosses whole() const { return mean(whole_); }
  /// Of warped images alone, each pixel counting as far as all three predictions land on it: from 0 to 1.
  PredictionLosses landed() const { return mean(landed_); }
  /// How much of the images that is.
  double landed_share() const;

  /// `loss` over `ideal`; nothing where that is rounding alone, as nothing moves.
  std::optional<double> ratio(double loss, double ideal) const;

  Json to_json() const;
  /// A table and what it means.
  std::string to_text() const;

 private:
  PredictionLosses mean(const PredictionLosses& sums) const;

  Lens lens_;
  double beta_;
  std::int64_t triplets_ = 0;
  PredictionLosses whole_, landed_;  // sums
  double landed_pixels_ = 0;
};

}  // namespace vkopple
