#include "graph/tensor.h"

#include <fmt/format.h>

#include "graph/float16.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

/// Calls visit(index in row-major order, index in NC4HW4).
template <class Visit>
void for_each_channels4(const Shape& shape, Visit visit) {
  const int64_t channels = shape[1];
  const int64_t pixels = shape[2] * shape[3];
  const int64_t blocks = blocks4(channels);
  for (int64_t n = 0; n < shape[0]; ++n)
    for (int64_t c = 0; c < channels; ++c)
      for (int64_t p = 0; p < pixels; ++p)
        visit(static_cast<size_t>((n * channels + c) * pixels + p),
              static_cast<size_t>(((n * blocks + c / 4) * pixels + p) * 4 + c % 4));
}

}  // namespace

uint64_t TensorSpec::elements() const {
  if (layout == Layout::kRowMajor && storage != Storage::kFloat32)
    throw Error(fmt::format("row-major tensors are never float16, and {} is to be one", shape.text()));
  if (layout == Layout::kRowMajor) return static_cast<uint64_t>(shape.elements());
  if (shape.rank() != 4) throw Error(fmt::format("NC4HW4 takes shapes (N, C, H, W), not {}", shape.text()));
  return static_cast<uint64_t>(shape[0] * blocks4(shape[1]) * shape[2] * shape[3]) * 4;
}

std::vector<float> to_layout(const TensorSpec& spec, std::span<const float> values) {
  if (static_cast<int64_t>(values.size()) != spec.shape.elements())
    throw Error(fmt::format("{} values were given for a tensor of shape {}", values.size(), spec.shape.text()));
  if (spec.layout == Layout::kRowMajor) return {values.begin(), values.end()};
  std::vector<float> stored(spec.elements(), 0.0F);
  for_each_channels4(spec.shape, [&](size_t row, size_t packed) { stored[packed] = values[row]; });
  return spec.storage == Storage::kFloat16 ? to_float16(stored) : stored;
}

std::vector<float> from_layout(const TensorSpec& spec, std::span<const float> stored) {
  if (stored.size() != spec.bytes() / 4)
    throw Error(fmt::format("{} stored words can't be a tensor of shape {}", stored.size(), spec.shape.text()));
  if (spec.layout == Layout::kRowMajor) return {stored.begin(), stored.end()};
  std::vector<float> values(static_cast<size_t>(spec.shape.elements()));
  const auto wide = spec.storage == Storage::kFloat16 ? from_float16(stored) : std::vector<float>{};
  const std::span<const float> all = wide.empty() ? stored : std::span<const float>(wide);
  for_each_channels4(spec.shape, [&](size_t row, size_t packed) { values[row] = all[packed]; });
  return values;
}

}  // namespace vkopple
