#pragma once

#include <future>
#include <memory>

#include "train/data/triplets.h"

namespace vkopple {

/// Reads the batch after the one asked for in a thread of its own, so that files are read and decoded while a
/// step runs. What comes out is what the source gives, errors included, at the step that they belong to. The
/// source must not need the device, whose queue is the caller's.
class ReadAhead : public TripletSource {
 public:
  explicit ReadAhead(std::unique_ptr<TripletSource> source) : source_(std::move(source)) {}

  TripletBatch read(uint64_t step) override;
  std::optional<uint64_t> size() const override { return source_->size(); }

 private:
  TripletBatch ready(uint64_t step);

  std::unique_ptr<TripletSource> source_;
  uint64_t ahead_step_ = 0;
  std::future<TripletBatch> ahead_;  ///< last, so that its thread ends before the source does
};

}  // namespace vkopple
