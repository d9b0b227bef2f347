#pragma once

#include <stdexcept>
#include <string>

namespace vkopple {

/// The work failed. `what()` is one line that names the file or value concerned and what to do about it.
/// The command line prints it and exits with 1.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The caller asked for something that can't be: an unknown option, key or name. The command line exits with 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

}  // namespace vkopple
