#include "train/step_batch.h"

#include <algorithm>
#include <numeric>

#include "train/random.h"

namespace vkopple {
namespace {

// Rooms take the lower streams of their seed, which may be the same number.
constexpr uint64_t kReversalStreams = uint64_t{6} << 61;
constexpr uint64_t kPermutationStreams = uint64_t{7} << 61;

}  // namespace

std::vector<bool> reversed_triplets(uint64_t seed, uint64_t step, int batch, double probability) {
  Random random(seed, kReversalStreams + step);
  std::vector<bool> reversed;
  for (int i = 0; i < batch; ++i) reversed.push_back(random.uniform() < probability);
  return reversed;
}

std::vector<uint32_t> scene_permutation(uint64_t seed, uint64_t step, int batch, BatchPart portion) {
  Random random(seed, kPermutationStreams + step);
  std::vector<uint32_t> order(static_cast<size_t>(batch));
  std::iota(order.begin(), order.end(), 0U);
  for (size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[random.below(static_cast<uint32_t>(i))]);
  const auto length = static_cast<uint32_t>(order.size() / portion.count);
  const auto first = static_cast<uint32_t>(portion.index) * length;
  std::erase_if(order, [&](uint32_t scene) { return scene < first || scene - first >= length; });
  for (uint32_t& scene : order) scene -= first;
  return order;
}

Triplets model_triplets(const TripletBatch& batch, std::vector<uint32_t> permutation) {
  Triplets triplets;
  triplets.drawn = batch.drawn;
  for (size_t frame = 0; frame < 3; ++frame) {
    triplets.images.insert(triplets.images.end(), batch.images[frame].begin(), batch.images[frame].end());
    const std::vector<float>& numbers = batch.poses[frame];
    for (size_t i = 0; i + 6 <= numbers.size(); i += 6) {
      CameraPose pose{};
      std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(i), 6, pose.begin());
      triplets.poses.push_back(pose);
    }
  }
  triplets.permutation = std::move(permutation);
  return triplets;
}

Triplets training_triplets(TripletSource& source, uint64_t seed, uint64_t step, int batch,
                           double reverse_probability, int first_frame, BatchPart part, BatchPart portion) {
  const auto all = reversed_triplets(seed, step, batch, reverse_probability);
  const auto length = static_cast<std::ptrdiff_t>(all.size() / (portion.count * part.count));
  const auto begin =
      all.begin() + static_cast<std::ptrdiff_t>(portion.index * part.count + part.index) * length;
  const std::vector<bool> reversed(begin, begin + length);
  return model_triplets(source.show(step * portion.count + portion.index, reversed, first_frame),
                        scene_permutation(seed, step, batch, portion));
}

}  // namespace vkopple
