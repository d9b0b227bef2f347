#pragma once

#include <barrier>
#include <functional>
#include <span>
#include <vector>

#include "graph/parallel/peers.h"

namespace vkopple::test {

/// Where threads that stand for processes meet.
class Meeting {
 public:
  explicit Meeting(int count) : given_(static_cast<size_t>(count)), barrier_(count) {}
  int count() const { return static_cast<int>(given_.size()); }
  /// What everyone gave, in the order of ranks.
  std::vector<std::vector<float>> exchange(int rank, std::span<const float> values);
  /// One does not come any more.
  void leave() { barrier_.arrive_and_drop(); }

 private:
  std::vector<std::vector<float>> given_;
  std::barrier<> barrier_;
};

/// Peers that are threads of the test.
class ThreadedPeers : public Peers {
 public:
  ThreadedPeers(Meeting& meeting, int rank) : meeting_(meeting), rank_(rank) {}
  ~ThreadedPeers() override { meeting_.leave(); }
  int rank() const override { return rank_; }
  int count() const override { return meeting_.count(); }

 private:
  void all_gather(std::span<const float> mine, std::span<float> all) override;
  void all_to_all(std::span<const float> parts, std::span<float> mine) override;

  Meeting& meeting_;
  int rank_;
};

/// Runs `work` in as many threads, each with its peers, and waits for all. What one throws fails the test.
void run_together(int count, const std::function<void(Peers&)>& work);

}  // namespace vkopple::test
