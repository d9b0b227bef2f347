#include "train/depth_probe.h"

#include "train/metrics.h"

namespace vkopple {

DepthProbe::DepthProbe(const ModelStore& store, const ModelConfig& config, const RoomsConfig& rooms, int batch,
                       uint64_t seed)
    : perception_(store.device(), config, store.groups(), {.batch = batch, .objects = false}),
      rooms_(store.device(), Lens(config), rooms, batch, seed) {}

std::optional<double> DepthProbe::measure() {
  double sum = 0;
  int images = 0;
  const auto batch = static_cast<int>(perception_.batch());
  for (int first = 0; first < kImages; first += batch) {
    const TripletBatch truth = rooms_.read(static_cast<uint64_t>(first / batch));
    const std::vector<float> depth = perception_.see(truth.images[1]).depth;
    const size_t pixels = depth.size() / static_cast<size_t>(batch);
    for (size_t begin = 0; begin < depth.size(); begin += pixels) {
      Correlation correlation;
      for (size_t p = begin; p < begin + pixels; ++p) correlation.add(truth.depth[p], depth[p]);
      const auto r = correlation.r();
      if (!r) continue;
      sum += *r;
      ++images;
    }
  }
  if (images == 0) return std::nullopt;
  return sum / images;
}

}  // namespace vkopple
