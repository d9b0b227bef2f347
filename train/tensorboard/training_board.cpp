#include "train/tensorboard/training_board.h"

#include <optional>

#include "train/pictures.h"

namespace vkopple {

void TrainingBoard::add(const StepRecord& record) {
  if (record.stage != last_.stage) flush();
  last_ = record;
  if (!record.skipped) {
    for (const auto& [name, loss] : record.losses) sums_[name] += loss;
    ++good_;
  }
  seconds_ += record.seconds;
  data_seconds_ += record.data_seconds;
  if (++steps_ == kSteps) flush();
  add_measured(record);
}

void TrainingBoard::flush() {
  if (steps_ == 0) return;
  EventFile::Scalars scalars{{"learning_rate", last_.learning_rate}};
  for (const auto& [name, sum] : sums_) scalars["loss/" + name] = sum / good_;
  if (last_.skipped_steps > 0) scalars["skipped_steps"] = static_cast<double>(last_.skipped_steps);
  if (seconds_ > 0) {
    scalars["speed/triplets_per_second"] = last_.batch * steps_ / seconds_;
    scalars["speed/data_share"] = data_seconds_ / seconds_;
  }
  file_.add(last_.step, scalars);
  sums_.clear();
  seconds_ = data_seconds_ = 0;
  steps_ = good_ = 0;
}

void TrainingBoard::add_measured(const StepRecord& record) {
  EventFile::Scalars scalars;
  for (const auto& [network, norms] : record.norms) {
    scalars["weight_norm/" + network] = norms.weights;
    scalars["gradient_norm/" + network] = norms.gradient;
  }
  const auto add_known = [&](const char* name, const std::optional<double>& score) {
    if (score) scalars[std::string("held_out/") + name] = *score;
  };
  if (record.held_out) {
    add_known("ari_fg", record.held_out->ari_fg);
    add_known("iou", record.held_out->iou);
    add_known("depth_r", record.held_out->depth_r);
  }
  if (!scalars.empty()) file_.add(record.step, scalars);
}

void TrainingBoard::show(uint64_t step, const std::vector<std::vector<RgbImage>>& rows) {
  if (!rows.empty()) file_.add(step, "held_out", picture_grid(rows));
}

}  // namespace vkopple
