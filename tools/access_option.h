#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <optional>
#include <string>

#include "runtime/caps.h"

namespace vkopple {

/// Adds `--access texel|storage` to a command; none where it is not given. Where the device can't have it,
/// Device says so.
inline void add_access_option(CLI::App& command, std::optional<AccessPath>& access) {
  static const std::map<std::string, AccessPath> paths{{"texel", AccessPath::kTexel},
                                                       {"storage", AccessPath::kStorage}};
  command
      .add_option_function<std::string>(
          "--access", [&access](const std::string& name) { access = paths.at(name); },
          "How kernels read: texel (uniform texel buffers) or storage (storage buffers, everywhere; default: "
          "what the device is faster with)")
      ->check(CLI::IsMember({"texel", "storage"}));
}

}  // namespace vkopple
