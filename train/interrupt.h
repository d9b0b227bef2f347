#pragma once

#include <signal.h>

namespace vkopple {

/// While it lives, the first SIGINT (Ctrl-C) or SIGTERM only raises a flag, so that work can end in order; the
/// second ends the program as usual. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  bool requested() const;

 private:
  struct sigaction interrupt_before_ {};
  struct sigaction terminate_before_ {};
};

}  // namespace vkopple
