#pragma once

#include <span>
#include <string>
#include <string_view>

#include "runtime/device_choice.h"

namespace vkopple {

/// Index of the device that the process with number `process` of a machine takes where every one is told
/// `selector`: "auto" deals the devices of the best type round, anything else names one for all. Throws as
/// choose_device does.
size_t choose_own_device(std::span<const Candidate> candidates, std::string_view selector, int process);

/// The selector of that device among those of this machine; `option` is what --device said.
std::string own_device(const std::string& option, int process);

}  // namespace vkopple
