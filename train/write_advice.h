#pragma once

#include <string_view>

namespace vkopple {

/// What to do where a file could not be written for the reason `code` (errno): "; free some space or ...", or
/// nothing.
std::string_view write_advice(int code);

}  // namespace vkopple
