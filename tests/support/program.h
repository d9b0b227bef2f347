#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vkopple::test {

/// How a run of the program ended.
struct Outcome {
  int code = -1;  ///< exit code; 128 + signal where it was killed
  std::string output, errors;

  /// Of standard error.
  int lines() const;
};

/// Runs the vkopple that was built with these arguments, in the current folder, and waits. On the device that
/// tests use, with a pipeline cache of the tests. `output`: where standard output goes instead of the outcome.
Outcome run_vkopple(const std::vector<std::string>& arguments, const std::filesystem::path& output = {});

/// Expects that the program failed with `code` and one line on standard error that holds each of `parts`.
void expect_failure(const Outcome& outcome, int code, const std::vector<std::string>& parts);

/// Expects exit code 0.
void expect_success(const Outcome& outcome);

}  // namespace vkopple::test
