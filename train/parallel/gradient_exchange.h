#pragma once

#include <future>
#include <map>
#include <string>
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
  Peers& peers_;
  std::vector<std::pair<std::string, std::shared_future<std::vector<float>>>> under_way_;
  double begun_at_ = 0;  ///< Peers::seconds() then
  double hidden_seconds_ = 0;
};

}  // namespace vkopple
