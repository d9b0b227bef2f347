#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/caps.h"

namespace vkopple {

/// A physical device as choosing sees it.
struct Candidate {
  Caps caps;
  std::vector<std::string> missing;  ///< what it lacks of what vkopple needs; empty: it can be used
};

/// Index of the candidate that `selector` names: "auto" (discrete before integrated before virtual before CPU),
/// "cpu", an index, a UUID, or part of the name, in any case. Throws Error when none is usable (with every
/// candidate's reasons), UsageError when the selector names none or one that can't be used.
size_t choose_device(std::span<const Candidate> candidates, std::string_view selector);

/// The selector that holds: `option` unless it is empty, else VKOPPLE_DEVICE, else "auto".
std::string device_selector(std::string_view option);

}  // namespace vkopple
