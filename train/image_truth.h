#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "train/data/triplets.h"
#include "train/evaluation_scores.h"

namespace vkopple {

/// One image of data and what is known of it; spans are those of its batch.
struct ImageTruth {
  int height = 0, width = 0;
  std::span<const float> image;           ///< (3, height, width)
  std::vector<std::int32_t> labels;       ///< 0 background, 1.. objects; empty where unknown
  std::span<const float> depth;           ///< empty where unknown of the whole batch
  std::vector<LabelledLocation> objects;  ///< those in sight; none where unknown
};

/// Of a triplet's middle frame.
ImageTruth image_truth(const TripletBatch& batch, std::size_t index);

/// One of `count` equal parts; nothing of nothing.
template <class T>
std::span<const T> equal_part(const std::vector<T>& values, std::size_t index, std::size_t count) {
  return std::span(values).subspan(index * (values.size() / count), values.size() / count);
}

}  // namespace vkopple
