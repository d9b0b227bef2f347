#include "train/parallel/join.h"

#include <array>
#include <cstdlib>
#include <string>

#include "runtime/error.h"
#ifdef VKOPPLE_MPI
#include "train/parallel/mpi_peers.h"
#endif

namespace vkopple {
namespace {

/// Told by the launchers of Open MPI, MPICH, and Slurm with either.
int launched_processes() {
  constexpr std::array<const char*, 2> kSizes{"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"};
  for (const char* name : kSizes)
    if (const char* size = std::getenv(name)) return std::atoi(size);
  return 1;
}

}  // namespace

std::unique_ptr<JoinedPeers> join_peers(std::function<bool()> asked_to_stop) {
  const int processes = launched_processes();
  if (processes <= 1) return nullptr;
#ifdef VKOPPLE_MPI
  return std::make_unique<MpiPeers>(std::move(asked_to_stop));
#else
  throw Error("this vkopple was built without MPI, and " + std::to_string(processes) +
              " processes would each train the same; build it with -DVKOPPLE_MPI=ON, or start one");
#endif
}

}  // namespace vkopple
