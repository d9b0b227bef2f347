#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace vkopple {

/// The JSON text of a configuration that ships with the program (models/presets/NAME.json), or nothing.
std::optional<std::string_view> find_preset(std::string_view name);
/// In alphabetical order.
std::vector<std::string_view> preset_names();

}  // namespace vkopple
