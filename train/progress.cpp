#include "train/progress.h"

#include <fmt/format.h>

#include <cmath>

namespace vkopple {
namespace {

// Share of the newest step in the mean time of steps, from which the time left is told.
constexpr double kNewest = 0.05;

}  // namespace

std::string duration_text(double seconds) {
  const auto whole = static_cast<uint64_t>(std::llround(std::fmax(seconds, 0)));
  const uint64_t days = whole / 86400, hours = whole / 3600 % 24, minutes = whole / 60 % 60, rest = whole % 60;
  if (days > 0) return fmt::format("{} d {}:{:02}:{:02}", days, hours, minutes, rest);
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, rest);
  return fmt::format("{}:{:02}", minutes, rest);
}

std::string progress_line(const StepRecord& record, uint64_t total, double seconds_per_step,
                          const Colours& colours) {
  std::string line = fmt::format("{}/{} {}", record.step, total, colours.stage(record.stage));
  if (const auto found = record.losses.find("total"); found != record.losses.end())
    line += fmt::format("  total {:.4g}", found->second);
  for (const auto& [name, value] : record.losses)
    if (name != "total") line += fmt::format("  {} {:.4g}", name, value);
  const auto add_known = [&](const char* name, const std::optional<double>& score) {
    if (score) line += "  " + colours.score(fmt::format("{} {:.3f}", name, *score));
  };
  if (record.held_out) {
    add_known("ARI-fg", record.held_out->ari_fg);
    add_known("IoU", record.held_out->iou);
    add_known("depth r", record.held_out->depth_r);
  }
  if (record.skipped_steps > 0) line += fmt::format("  {} skipped", record.skipped_steps);
  if (record.shared) line += fmt::format("  efficiency {:.0f} %", 100 * record.shared->efficiency);
  const double rate = seconds_per_step > 0 ? record.batch / seconds_per_step : 0;
  const uint64_t left = total > record.step ? total - record.step : 0;
  return line + fmt::format("  {:.3g} triplets/s  {} left", rate,
                            duration_text(static_cast<double>(left) * seconds_per_step));
}

void Progress::learn_pace(const StepRecord& record) {
  if (record.stage != stage_) steps_of_stage_ = 0;
  stage_ = record.stage;
  // The first step of a stage also makes pipelines; the second forgets it.
  const bool fresh = ++steps_of_stage_ <= 2;
  seconds_per_step_ =
      fresh ? record.seconds : seconds_per_step_ + kNewest * (record.seconds - seconds_per_step_);
}

void Progress::show(const StepRecord& record) {
  learn_pace(record);
  if (record.held_out) held_out_ = record.held_out;

  StepRecord shown = record;
  shown.held_out = held_out_;
  line_.show(progress_line(shown, total_, seconds_per_step_, colours_), !begun_ || record.step == total_);
  begun_ = true;
}

}  // namespace vkopple
