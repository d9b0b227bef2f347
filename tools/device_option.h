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

/// Adds `--winograd auto|never|2|4` to a command, and `--no-winograd` for never.
inline void add_winograd_option(CLI::App& command, WinogradUse& winograd) {
  static const std::map<std::string, WinogradUse> uses{{"auto", WinogradUse::kWhereFaster},
                                                       {"never", WinogradUse::kNever},
                                                       {"2", WinogradUse::kTiles2},
                                                       {"4", WinogradUse::kTiles4}};
  CLI::Option* use =
      command
          .add_option_function<std::string>(
              "--winograd", [&winograd](const std::string& name) { winograd = uses.at(name); },
              "Winograd's algorithm for 3x3 convolutions of stride 1, which rounds somewhat more: auto "
              "(default; "
              "where it is faster), never, or wherever it can run with tiles of 2 x 2 or 4 x 4 outputs (2, 4)")
          ->check(CLI::IsMember({"auto", "never", "2", "4"}));
  command
      .add_flag_callback(
          "--no-winograd", [&winograd] { winograd = WinogradUse::kNever; }, "The same as --winograd never")
      ->excludes(use);
}

}  // namespace vkopple
