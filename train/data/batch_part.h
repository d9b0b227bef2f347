#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "train/data/triplets.h"

namespace vkopple {

/// One of `count` runs of equal length of every batch: what one of several processes sees of it, or the portion
/// that is worked off at once.
struct BatchPart {
  uint64_t index = 0;
  uint64_t count = 1;
};

/// A part of the batches of a source whose own batches are as long as a part: those that follow each other
/// there make a whole batch here.
class PartSource : public TripletSource {
 public:
  PartSource(std::unique_ptr<TripletSource> source, BatchPart part) : source_(std::move(source)), part_(part) {}

  TripletBatch read(uint64_t step) override { return source_->read(step_there(step)); }
  TripletBatch read_shown(uint64_t step) override { return source_->read_shown(step_there(step)); }
  TripletBatch show(uint64_t step, const std::vector<bool>& reversed, int first_frame) override {
    return source_->show(step_there(step), reversed, first_frame);
  }
  std::optional<uint64_t> size() const override { return source_->size(); }

 private:
  uint64_t step_there(uint64_t step) const { return step * part_.count + part_.index; }

  std::unique_ptr<TripletSource> source_;
  BatchPart part_;
};

}  // namespace vkopple
