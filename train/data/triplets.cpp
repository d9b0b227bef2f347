#include "train/data/triplets.h"

#include <algorithm>
#include <cstddef>

namespace vkopple {
namespace {

/// Exchanges element `index` of two arrays with `stride` numbers each.
void exchange(std::vector<float>& a, std::vector<float>& b, std::size_t index, std::size_t stride) {
  const auto from = static_cast<std::ptrdiff_t>(index * stride),
             to = static_cast<std::ptrdiff_t>((index + 1) * stride);
  std::swap_ranges(a.begin() + from, a.begin() + to, b.begin() + from);
}

}  // namespace

void TripletBatch::reverse(int index) {
  const auto element = static_cast<std::size_t>(index);
  exchange(images[0], images[2], element,
           std::size_t{3} * static_cast<std::size_t>(height) * static_cast<std::size_t>(width));
  exchange(poses[0], poses[2], element, 6);
}

TripletBatch TripletSource::show(uint64_t step, const std::vector<bool>& reversed, int /*first_frame*/) {
  TripletBatch batch = read_shown(step);
  for (int i = 0; i < batch.batch; ++i)
    if (reversed.at(static_cast<std::size_t>(i))) batch.reverse(i);
  return batch;
}

std::vector<std::array<int, 3>> strided_triplets(int frames) {
  std::vector<std::array<int, 3>> triplets;
  for (int stride = 1; 2 * stride < frames; ++stride) {
    for (int first = 0; first + 2 * stride < frames; ++first)
      triplets.push_back({first, first + stride, first + 2 * stride});
  }
  return triplets;
}

}  // namespace vkopple
