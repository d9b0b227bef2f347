#include "train/parallel/join.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <string>
#include <system_error>

#include "runtime/error.h"
#ifdef VKOPPLE_MPI
#include "train/parallel/mpi_peers.h"
#endif

namespace vkopple {
namespace {

int processes_in(const char* name, const std::string& text) {
  int processes = 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, processes);
  if (read.ec != std::errc() || read.ptr != end || processes < 1)
    throw Error(
        fmt::format("the environment's {} is '{}' and must be a number of processes; unset it to train by one",
                    name, text));
  return processes;
}

}  // namespace

int launched_processes(const Environment& environment) {
  // Of Open MPI's mpirun; of MPICH's, and of Slurm with PMI-2.
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* size = environment(name)) return processes_in(name, size);
  // PMIx tells a rank and no size. Slurm does, but of every step, those without MPI as well.
  constexpr const char* kStep = "SLURM_STEP_NUM_TASKS";
  if (environment("PMIX_RANK") != nullptr)
    if (const char* size = environment(kStep)) return processes_in(kStep, size);
  return 1;
}

std::unique_ptr<JoinedPeers> join_peers(std::function<bool()> asked_to_stop) {
  const int processes = launched_processes([](const char* name) { return std::getenv(name); });
  if (processes <= 1) return nullptr;
#ifdef VKOPPLE_MPI
  return std::make_unique<MpiPeers>(std::move(asked_to_stop));
#else
  throw Error(
      fmt::format("this vkopple was built without MPI, and {} processes would each train the same; build it "
                  "with -DVKOPPLE_MPI=ON, or start one",
                  processes));
#endif
}

}  // namespace vkopple
