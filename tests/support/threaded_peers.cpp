#include "tests/support/threaded_peers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <thread>

namespace vkopple::test {

std::vector<std::vector<float>> Meeting::exchange(int rank, std::span<const float> values) {
  given_[static_cast<size_t>(rank)].assign(values.begin(), values.end());
  barrier_.arrive_and_wait();
  auto all = given_;
  barrier_.arrive_and_wait();
  for (const auto& one : all)
    if (one.size() != values.size())
      throw std::runtime_error("threads exchanged other numbers of values, or one left");
  return all;
}

void ThreadedPeers::all_gather(std::span<const float> mine, std::span<float> all) {
  auto at = all.begin();
  for (const auto& one : meeting_.exchange(rank_, mine)) at = std::copy(one.begin(), one.end(), at);
}

void ThreadedPeers::all_to_all(std::span<const float> parts, std::span<float> mine) {
  const auto part = static_cast<std::ptrdiff_t>(parts.size()) / count();
  auto at = mine.begin();
  for (const auto& one : meeting_.exchange(rank_, parts))
    at = std::copy_n(one.begin() + rank_ * part, part, at);
}

void run_together(int count, const std::function<void(Peers&)>& work) {
  Meeting meeting(count);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < count; ++rank)
    threads.emplace_back([&, rank] {
      ThreadedPeers peers(meeting, rank);
      try {
        work(peers);
      } catch (const std::exception& error) {
        ADD_FAILURE() << "thread " << rank << ": " << error.what();
      }
    });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace vkopple::test
