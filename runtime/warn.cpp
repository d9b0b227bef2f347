#include "runtime/warn.h"

#include <spdlog/spdlog.h>

#include <cstdio>
#include <string>

namespace vkopple {

void warn(std::string_view message) {
  if (const auto logger = spdlog::get("vkopple")) {
    logger->warn(message);
    return;
  }
  std::fputs(("vkopple: warning: " + std::string(message) + "\n").c_str(), stderr);
}

}  // namespace vkopple
