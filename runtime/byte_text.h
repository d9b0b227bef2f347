#pragma once

#include <cstdint>
#include <string>

namespace vkopple {

/// "812 bytes", "3.1 KiB", "512.0 MiB", "1.9 GiB".
std::string byte_text(uint64_t bytes);

}  // namespace vkopple
