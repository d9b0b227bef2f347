#pragma once

#include <span>
#include <vector>

namespace vkopple {

/// The processes that train one model together, each on a part of every batch. All of them call the same
/// functions in the same order, with as many values; each call waits for all. Throws Error where a process is
/// gone.
class Peers {
 public:
  Peers() = default;
  virtual ~Peers() = default;
  Peers(const Peers&) = delete;
  Peers& operator=(const Peers&) = delete;

  virtual int rank() const = 0;  ///< of this process, from 0
  virtual int count() const = 0;

  /// What every process gave, in the order of ranks.
  std::vector<float> gather(std::span<const float> values);
  /// Puts the mean over all processes in place of values. Sums are taken in the order of ranks: every process
  /// gets the same bits, and gets them again next time.
  void average(std::span<float> values);

  /// Spent in exchanges so far, waiting for others included.
  double seconds() const { return seconds_; }

 private:
  /// `all` takes count() runs as long as `mine`, in the order of ranks.
  virtual void all_gather(std::span<const float> mine, std::span<float> all) = 0;
  /// `parts` are count() runs, one for each process; `mine` takes the runs for this one, in the order of ranks.
  virtual void all_to_all(std::span<const float> parts, std::span<float> mine) = 0;

  double seconds_ = 0;
};

/// Whether there is anybody to share with. `peers` may be null.
inline bool several(const Peers* peers) { return peers != nullptr && peers->count() > 1; }

}  // namespace vkopple
