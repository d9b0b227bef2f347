#include "train/parallel/gradient_exchange.h"

#include <algorithm>
#include <chrono>

namespace vkopple {

void GradientExchange::begin(const std::string& group, std::vector<float> gradient) {
  std::shared_future<void> before;
  if (under_way_.empty())
    begun_at_ = peers_.seconds();
  else
    before = under_way_.back().done;
  Exchange& exchange = under_way_.emplace_back(group, std::move(gradient));
  auto work = [&peers = peers_, before = std::move(before), &values = exchange.values] {
    if (before.valid()) before.get();  // one after the other, and none after one that failed
    peers.average(values);
  };
  exchange.done = std::async(std::launch::async, std::move(work)).share();
}

std::map<std::string, std::vector<float>> GradientExchange::finish() {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  std::map<std::string, std::vector<float>> means;
  std::list<Exchange> exchanges = std::exchange(under_way_, {});
  for (Exchange& exchange : exchanges) {
    exchange.done.get();
    means.emplace(exchange.group, std::move(exchange.values));
  }
  const double waited = std::chrono::duration<double>(Clock::now() - start).count();
  hidden_seconds_ = means.empty() ? 0 : std::max(peers_.seconds() - begun_at_ - waited, 0.0);
  return means;
}

}  // namespace vkopple
