#pragma once

namespace vkopple::fuzz {

/// Keeps warnings to itself while it lives: damaged files cause them by the thousand.
class Quiet {
 public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
};

}  // namespace vkopple::fuzz
