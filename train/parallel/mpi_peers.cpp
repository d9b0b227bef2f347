#ifdef VKOPPLE_MPI
#include "train/parallel/mpi_peers.h"

#include <fmt/format.h>
#include <mpi.h>

#include <array>
#include <chrono>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <thread>

#include "runtime/error.h"

namespace vkopple {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// How long a process that failed lets process 0 speak first, and end it: as a rule all fail for one reason.
constexpr milliseconds kTurn{2000};
/// After a signal, others that still work answer within a step; launchers kill a second after it.
constexpr milliseconds kPatience{500};
constexpr std::chrono::microseconds kSleep{50};

void check(int result, const char* what) {
  if (result == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(result, text.data(), &length);
  throw Error(
      fmt::format("{}: {}; another process may have ended: go on from the last checkpoint with --resume", what,
                  std::string(text.data(), static_cast<size_t>(length))));
}

int counted(size_t values) {
  if (values > INT_MAX) throw Error(fmt::format("{} numbers are too many for a message of MPI", values));
  return static_cast<int>(values);
}

}  // namespace

/// One collective operation under way. Waits asleep: processes may share their cores with each other's devices.
class MpiPeers::Exchange {
 public:
  explicit Exchange(const MpiPeers& peers) : peers_(peers) {}
  MPI_Request* request() { return &request_; }

  void wait(const char* what) {
    const auto begin = Clock::now();
    std::optional<Clock::time_point> asked;
    bool told = false;
    for (int done = 0; done == 0;) {
      check(MPI_Test(&request_, &done, MPI_STATUS_IGNORE), what);
      if (done != 0) return;
      const auto now = Clock::now();
      if (now - begin > milliseconds(1)) std::this_thread::sleep_for(kSleep);
      if (told || !peers_.asked_to_stop_()) continue;
      if (!asked) asked = now;
      if (now - *asked < kPatience) continue;
      tell_of_waiting();
      told = true;
    }
  }

 private:
  void tell_of_waiting() const {
    std::fputs(
        fmt::format("vkopple: process {} of {} was asked to stop, and waits for others that do not answer; if "
                    "one has ended, go on from the last checkpoint with --resume\n",
                    peers_.rank_, peers_.count_)
            .c_str(),
        stderr);
  }

  const MpiPeers& peers_;
  MPI_Request request_ = MPI_REQUEST_NULL;
};

MpiPeers::MpiPeers(std::function<bool()> asked_to_stop) : asked_to_stop_(std::move(asked_to_stop)) {
  int threads = MPI_THREAD_SINGLE;
  check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &threads), "MPI_Init_thread");
  if (threads < MPI_THREAD_SERIALIZED)
    throw Error("this MPI allows no calls from a second thread; use one that has MPI_THREAD_SERIALIZED");
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  check(MPI_Comm_rank(MPI_COMM_WORLD, &rank_), "MPI_Comm_rank");
  check(MPI_Comm_size(MPI_COMM_WORLD, &count_), "MPI_Comm_size");
  MPI_Comm machine = MPI_COMM_NULL;
  check(MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine),
        "MPI_Comm_split_type");
  check(MPI_Comm_rank(machine, &rank_on_machine_), "MPI_Comm_rank");
  MPI_Comm_free(&machine);
}

MpiPeers::~MpiPeers() { MPI_Finalize(); }

void MpiPeers::abandon(const std::string& message, int code) {
  const auto end = Clock::now() + kTurn;
  const bool asked_before = asked_to_stop_();
  while (rank_ != 0 && Clock::now() < end) {
    if (asked_to_stop_() && !asked_before) std::_Exit(code);
    std::this_thread::sleep_for(milliseconds(20));
  }
  std::fputs(fmt::format("vkopple: process {} of {}: {}\n", rank_, count_, message).c_str(), stderr);
  std::fflush(stderr);
  MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

void MpiPeers::all_gather(std::span<const float> mine, std::span<float> all) {
  Exchange exchange(*this);
  check(MPI_Iallgather(mine.data(), counted(mine.size()), MPI_FLOAT, all.data(), counted(mine.size()),
                       MPI_FLOAT, MPI_COMM_WORLD, exchange.request()),
        "MPI_Iallgather");
  exchange.wait("MPI_Iallgather");
}

void MpiPeers::all_to_all(std::span<const float> parts, std::span<float> mine) {
  Exchange exchange(*this);
  const int part = counted(parts.size() / static_cast<size_t>(count_));
  check(MPI_Ialltoall(parts.data(), part, MPI_FLOAT, mine.data(), part, MPI_FLOAT, MPI_COMM_WORLD,
                      exchange.request()),
        "MPI_Ialltoall");
  exchange.wait("MPI_Ialltoall");
}

}  // namespace vkopple
#endif
