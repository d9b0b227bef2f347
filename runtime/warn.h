#pragma once

#include <string_view>

namespace vkopple {

/// Tells of what goes wrong without stopping the work: one line to spdlog's logger "vkopple", which the program
/// sets up, or to standard error where there is no such logger (programs that link the library).
void warn(std::string_view message);

}  // namespace vkopple
