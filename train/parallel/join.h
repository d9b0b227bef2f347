#pragma once

#include <functional>
#include <memory>
#include <string>

#include "graph/parallel/peers.h"

namespace vkopple {

/// This process's place among those that mpirun, or another launcher of MPI, started together.
class JoinedPeers : public Peers {
 public:
  /// Number of this process among those on its machine.
  virtual int rank_on_machine() const = 0;
  /// Says on standard error what failed here, and ends all processes with exit code `code`.
  [[noreturn]] virtual void abandon(const std::string& message, int code) = 0;
};

/// Looks up a variable of the environment; null where there is none.
using Environment = std::function<const char*(const char* name)>;

/// How many processes the launcher of this one started together, as it tells in the environment; 1 without a
/// launcher that is known. Throws Error where what it tells is no number.
int launched_processes(const Environment& environment);

/// Joins them; null where this process was started alone. `asked_to_stop` tells of a signal that came while
/// this process waits for others. Throws Error where there are several and this program was built without MPI.
std::unique_ptr<JoinedPeers> join_peers(std::function<bool()> asked_to_stop);

}  // namespace vkopple
