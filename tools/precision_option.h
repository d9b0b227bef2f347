#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "models/precision.h"

namespace vkopple {

/// Adds `--precision float32|mixed` to a command; `chosen` is assigned where it is given.
template <class T>
void add_precision_option(CLI::App& command, T& chosen, const std::string& standard) {
  const std::vector<std::string> names(kPrecisionNames.begin(), kPrecisionNames.end());
  command
      .add_option_function<std::string>(
          "--precision",
          [&chosen, names](const std::string& name) {
            chosen = static_cast<Precision>(std::find(names.begin(), names.end(), name) - names.begin());
          },
          "float32, or mixed: what lies between the networks' layers is kept in float16, which takes half the "
          "memory (default: " +
              standard + ")")
      ->check(CLI::IsMember(names));
}

}  // namespace vkopple
