#include "train/data/read_ahead.h"

namespace vkopple {

TripletBatch ReadAhead::ready(uint64_t step) {
  const auto found = ahead_.find(step);
  if (found == ahead_.end()) {
    ahead_.clear();  // waits for what nobody wants
    return source_->read_shown(step);
  }
  std::future<TripletBatch> batch = std::move(found->second);
  ahead_.erase(ahead_.begin(), std::next(found));
  return batch.get();
}

TripletBatch ReadAhead::read_shown(uint64_t step) {
  TripletBatch batch = ready(step);
  for (uint64_t next = step + 1; next <= step + static_cast<uint64_t>(threads_); ++next) {
    if (!ahead_.contains(next))
      ahead_.emplace(next, std::async(std::launch::async, [this, next] { return source_->read_shown(next); }));
  }
  return batch;
}

}  // namespace vkopple
