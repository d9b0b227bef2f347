#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "models/precision.h"
#include "runtime/caps.h"
#include "runtime/error.h"

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

/// Throws UsageError for `--kernels cooperative` in float32, which those kernels never touch.
inline void require_kernels_suit(KernelFamily kernels, Precision precision) {
  if (kernels == KernelFamily::kCooperative && precision != Precision::kMixed)
    throw UsageError(
        "--kernels cooperative multiplies float16 and goes with --precision mixed of train, infer and bench; "
        "float32 takes --kernels shared");
}

}  // namespace vkopple
