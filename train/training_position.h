#pragma once

#include <cstdint>
#include <string>

namespace vkopple {

/// How far a run has come. All randomness of training is a function of seed and step, so this is its random
/// state as well.
struct TrainingPosition {
  uint64_t step = 0;        ///< steps done
  uint64_t stage = 0;       ///< of the last step done; 0 before the first
  uint64_t stage_step = 0;  ///< steps done in that stage
  uint64_t seed = 0;
  std::string data;               ///< what --data said
  uint64_t skipped = 0;           ///< steps that changed nothing, as something was not finite
  uint64_t skipped_in_a_row = 0;  ///< the last ones

  bool operator==(const TrainingPosition&) const = default;
};

}  // namespace vkopple
