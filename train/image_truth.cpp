#include "train/image_truth.h"

namespace vkopple {

ImageTruth image_truth(const TripletBatch& batch, std::size_t index) {
  const auto count = static_cast<std::size_t>(batch.batch);
  ImageTruth truth{.height = batch.height,
                   .width = batch.width,
                   .image = equal_part(batch.images[1], index, count),
                   .depth = equal_part(batch.depth, index, count)};
  const auto labels = equal_part(batch.label, index, count);
  if (!labels.empty() && labels[0] != kUnknownLabel) truth.labels.assign(labels.begin(), labels.end());
  if (batch.objects.empty()) return truth;
  const auto& objects = batch.objects[index];
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (objects[i].pixels > 0)
      truth.objects.push_back(
          {static_cast<std::int32_t>(i + 1), objects[i].location[0], objects[i].location[1]});
  return truth;
}

}  // namespace vkopple
