#pragma once

#include <future>
#include <map>
#include <memory>

#include "train/data/triplets.h"

namespace vkopple {

/// Reads the batches after the one asked for in threads of their own, one a batch, so that files are read and
/// decoded while a step runs. What comes out is what the source gives, errors included, at the step that they
/// belong to, however many threads there are. The source must bear that many readers at once, and not need the
/// device, whose queue is the caller's.
class ReadAhead : public TripletSource {
 public:
  ReadAhead(std::unique_ptr<TripletSource> source, int threads)
      : source_(std::move(source)), threads_(threads) {}

  TripletBatch read(uint64_t step) override { return source_->read(step); }
  /// This is what is read ahead.
  TripletBatch read_shown(uint64_t step) override;
  std::optional<uint64_t> size() const override { return source_->size(); }

 private:
  TripletBatch ready(uint64_t step);

  std::unique_ptr<TripletSource> source_;
  int threads_;
  std::map<uint64_t, std::future<TripletBatch>>
      ahead_;  ///< last, so that its threads end before the source does
};

}  // namespace vkopple
