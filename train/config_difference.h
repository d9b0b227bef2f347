#pragma once

#include <optional>
#include <string>

#include "models/config.h"

namespace vkopple {

/// A key in which two configurations differ, with both values as JSON ("absent" where there is none).
struct ConfigDifference {
  std::string key;  ///< in full: "training.stages[0].batch"
  std::string first, second;
};

/// The first difference, in the order in which to_json() writes; nothing between equal ones.
std::optional<ConfigDifference> first_difference(const Config& first, const Config& second);

}  // namespace vkopple
