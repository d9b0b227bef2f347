#pragma once

#include <string_view>

namespace vkopple {

/// Whether name `a` comes before `b` where numbers in names count as numbers: "frame2" before "frame10".
bool natural_less(std::string_view a, std::string_view b);

}  // namespace vkopple
