#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/config.h"
#include "models/training_config.h"
#include "runtime/caps.h"
#include "train/evaluation_scores.h"
#include "train/report/held_out.h"
#include "train/report/training_curves.h"
#include "train/training_position.h"

namespace vkopple {

/// Everything that a report tells.
struct Report {
  std::string model;    ///< as the user names it
  std::string command;  ///< that makes the report again
  std::string version;  ///< of this program
  Caps device;
  Config config;
  TrainingPosition position;
  std::vector<Network> untrained;        ///< networks that have not learned yet
  std::optional<TrainingCurves> curves;  ///< of a run
  std::string data;                      ///< that the model was looked at with
  double half_view = 0;                  ///< half the horizontal angle of view, radians
  HeldOut held_out;
  std::vector<Prediction> predictions;

  bool has_learned(Network network) const;
};

/// The page, whole in itself.
std::string report_page(const Report& report);

// Its sections; each says so where it has nothing to show.
std::string scores_section(const Report& report);
std::string pictures_section(const Report& report);
std::string prediction_section(const Report& report);
std::string places_section(const Report& report);
std::string poses_section(const Report& report);
std::string training_section(const Report& report);
std::string origin_section(const Report& report);

}  // namespace vkopple
