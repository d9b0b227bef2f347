#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace vkopple {

/// Adds `--device auto|cpu|INDEX|NAME|UUID` to a command.
inline void add_device_option(CLI::App& command, std::string& selector) {
  command.add_option(
      "--device", selector,
      "Vulkan device: auto, cpu, an index, a name or a UUID (default: $VKOPPLE_DEVICE, else auto)");
}

}  // namespace vkopple
