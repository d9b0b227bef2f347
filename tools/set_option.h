#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace vkopple {

/// Adds `--set KEY=VALUE` (models/config_override.h) to a command that takes a configuration.
inline CLI::Option* add_set_option(CLI::App& command, std::vector<std::string>& set) {
  return command
      .add_option("--set", set,
                  "KEY=VALUE in place of the configuration's, as model.statistics_frames=second or "
                  "training.stages[0].steps=100; may be repeated")
      ->allow_extra_args(false);
}

}  // namespace vkopple
