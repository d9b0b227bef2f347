#include "train/data/read_ahead.h"

namespace vkopple {

TripletBatch ReadAhead::ready(uint64_t step) {
  if (ahead_.valid()) {
    std::future<TripletBatch> ahead = std::move(ahead_);
    if (ahead_step_ == step) return ahead.get();
    ahead.wait();  // nobody wants it, but it holds the source
  }
  return source_->read(step);
}

TripletBatch ReadAhead::read(uint64_t step) {
  TripletBatch batch = ready(step);
  ahead_step_ = step + 1;
  ahead_ = std::async(std::launch::async, [this, next = step + 1] { return source_->read(next); });
  return batch;
}

}  // namespace vkopple
