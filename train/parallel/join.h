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

/// Joins them; null where this process was started alone. `asked_to_stop` tells of a signal that came while
/// this process waits for others. Throws Error where there are several and this program was built without MPI.
std::unique_ptr<JoinedPeers> join_peers(std::function<bool()> asked_to_stop);

}  // namespace vkopple
