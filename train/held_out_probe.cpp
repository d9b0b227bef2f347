#include "train/held_out_probe.h"

#include "train/evaluate.h"

namespace vkopple {

namespace {

PerceptionOptions perception_options(const HeldOutProbe::Options& options) {
  return {.batch = options.batch, .objects = options.objects};
}

}  // namespace

uint64_t HeldOutProbe::device_bytes(const Caps& caps, const ModelConfig& config, const RoomsConfig& rooms,
                                    const Options& options) {
  return perception_bytes(caps, config, perception_options(options)) +
         RoomSource::read_bytes(Lens(config), rooms, options.batch);
}

HeldOutProbe::HeldOutProbe(const ModelStore& store, const ModelConfig& config, const RoomsConfig& rooms,
                           const Options& options)
    : perception_(store.device(), config, store.groups(), perception_options(options)),
      rooms_(store.device(), Lens(config), rooms, options.batch, options.seed) {}

HeldOutScores HeldOutProbe::measure(std::vector<std::vector<RgbImage>>* pictures) {
  const EvaluationScores scores =
      evaluate(perception_, rooms_, kImages, {.grid = pictures, .grid_rows = kShown});
  return {.ari_fg = scores.ari_fg(), .iou = scores.iou(), .depth_r = scores.depth_r()};
}

}  // namespace vkopple
