#pragma once

#include <CLI/CLI.hpp>

namespace vkopple {

/// Adds one subcommand. Its callback does the work and throws Error (exit code 1) or UsageError (2); a callback
/// that found a failure it has already reported throws CLI::RuntimeError(1).
using AddCommand = void (*)(CLI::App& app);

}  // namespace vkopple
