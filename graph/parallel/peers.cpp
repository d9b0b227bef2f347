#include "graph/parallel/peers.h"

#include <algorithm>
#include <chrono>

namespace vkopple {
namespace {

class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

std::vector<float> Peers::gather(std::span<const float> values) {
  const Stopwatch stopwatch(seconds_);
  std::vector<float> all(values.size() * static_cast<size_t>(count()));
  all_gather(values, all);
  return all;
}

/// Each process sums a part of the values for all, so that as many bytes pass as in a ring, in a fixed order.
void Peers::average(std::span<float> values) {
  const Stopwatch stopwatch(seconds_);
  const auto n = static_cast<size_t>(count());
  const size_t part = (values.size() + n - 1) / n;
  std::vector<float> all(part * n), own(part * n);
  std::copy(values.begin(), values.end(), all.begin());
  all_to_all(all, own);
  for (size_t i = 0; i < part; ++i) {
    double sum = 0;
    for (size_t process = 0; process < n; ++process) sum += double{own[process * part + i]};
    own[i] = static_cast<float>(sum / static_cast<double>(n));
  }
  all_gather(std::span(own).first(part), all);
  std::copy_n(all.begin(), values.size(), values.begin());
}

}  // namespace vkopple
