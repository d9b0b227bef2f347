#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "runtime/caps.h"

namespace vkopple {

/// Adds `--device auto|cpu|INDEX|NAME|UUID` to a command.
inline void add_device_option(CLI::App& command, std::string& selector) {
  command.add_option(
      "--device", selector,
      "Vulkan device: auto, cpu, an index, a name or a UUID (default: $VKOPPLE_DEVICE, else auto)");
}

/// Adds `--kernels auto|registers|shared|cooperative|plain` to a command. Where the device can't run the
/// family, Device says so.
inline void add_kernels_option(CLI::App& command, KernelFamily& kernels) {
  static const std::map<std::string, KernelFamily> families{{"auto", KernelFamily::kAuto},
                                                            {"registers", KernelFamily::kRegisters},
                                                            {"shared", KernelFamily::kShared},
                                                            {"cooperative", KernelFamily::kCooperative},
                                                            {"plain", KernelFamily::kPlain}};
  command
      .add_option_function<std::string>(
          "--kernels", [&kernels](const std::string& name) { kernels = families.at(name); },
          "Kernels of convolutions and products: auto (default), registers (CPU devices), shared (shared "
          "memory, for GPUs), cooperative (matrix units, for GPUs in mixed precision) or plain (runs anywhere)")
      ->check(CLI::IsMember({"auto", "registers", "shared", "cooperative", "plain"}));
}

/// Adds `--no-winograd` to a command.
inline void add_winograd_option(CLI::App& command, bool& winograd) {
  command.add_flag("!--no-winograd", winograd,
                   "Convolve directly even where Winograd's algorithm is faster: it rounds somewhat more");
}

}  // namespace vkopple
