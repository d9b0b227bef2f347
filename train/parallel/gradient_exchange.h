#pragma once

#include <future>
#include <list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "graph/parallel/peers.h"

namespace vkopple {

/// Takes means of gradients over processes in a thread of its own, while the device goes on with backward. From
/// the first begin() to finish() nobody else may use the peers.
class GradientExchange {
 public:
  explicit GradientExchange(Peers& peers) : peers_(peers) {}

  /// Of one group of parameters; groups come in the same order in every process.
  void begin(const std::string& group, std::vector<float> gradient);
  /// Waits for all, and gives the means by group.
  std::map<std::string, std::vector<float>> finish();

  /// Of the exchanges that were finished last: the seconds of them in which nobody waited.
  double hidden_seconds() const { return hidden_seconds_; }

 private:
  /// One under way, whose thread works on `values`: it stays where it is, and waits for the thread at its end.
  struct Exchange {
    Exchange(std::string name, std::vector<float> numbers)
        : group(std::move(name)), values(std::move(numbers)) {}
    ~Exchange() {
      if (done.valid()) done.wait();
    }
    Exchange(const Exchange&) = delete;
    Exchange& operator=(const Exchange&) = delete;

    std::string group;
    std::vector<float> values;
    std::shared_future<void> done;
  };

  Peers& peers_;
  std::list<Exchange> under_way_;
  double begun_at_ = 0;  ///< Peers::seconds() then
  double hidden_seconds_ = 0;
};

}  // namespace vkopple
