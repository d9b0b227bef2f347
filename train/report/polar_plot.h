#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace vkopple {

/// A distribution over yaw as inline SVG, seen from above: bin m of b stands for 2πm/b, counter-clockwise from
/// the top, and lies as far from the middle as it is likely, the most likely on the rim. Dashed: what all bins
/// would have that were as likely as each other. `mark`: an angle to mark on the rim, radians. `text` says what
/// it shows to those who don't see it.
std::string polar_plot(std::span<const double> probabilities, std::optional<double> mark,
                       std::string_view text);

}  // namespace vkopple
