#include <fmt/format.h>

#include <algorithm>

#include "graph/conv/weight_gradient.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

/// How the sum is cut: strips of pixels within an image or of whole images, each summed by one workgroup.
struct BiasStrips {
  uint32_t lanes;  ///< invocations of a workgroup
  uint32_t images;
  uint32_t pixels;  ///< of an image
  uint32_t per_image;
  uint32_t total;
};

BiasStrips bias_strips(const TensorSpec& dy, const Caps& caps) {
  if (dy.layout != Layout::kChannels4 || dy.shape.rank() != 4)
    throw Error(fmt::format("a bias gradient takes NC4HW4 gradients of 4 axes, not {}", dy.shape.text()));
  const int64_t image = dy.shape[2] * dy.shape[3];
  BiasStrips strips{};
  // Long sums in few lanes where a workgroup is a subgroup; on GPUs more of them to fill the machine.
  strips.lanes = caps.cpu() ? std::clamp(caps.subgroup_size, 4U, 64U) : 64;
  const int64_t most = strips.lanes * (caps.cpu() ? 256 : 32);
  strips.per_image = static_cast<uint32_t>((image + most - 1) / most);
  strips.pixels = static_cast<uint32_t>((image + strips.per_image - 1) / strips.per_image);
  // A workgroup costs a CPU as much as some dozen pixels of each lane.
  const int64_t fewest = strips.lanes * (caps.cpu() ? 64 : 4);
  strips.images = static_cast<uint32_t>(std::clamp(fewest / image, int64_t{1}, dy.shape[0]));
  strips.total = (static_cast<uint32_t>(dy.shape[0]) + strips.images - 1) / strips.images * strips.per_image;
  return strips;
}

struct StripPush {
  uint32_t images, co4, image, strip_images, image_strips, strip_pixels;
};

struct SumPush {
  uint32_t co, co4, strips, accumulate;
};

}  // namespace

uint64_t bias_gradient_scratch(const TensorSpec& dy, const Caps& caps) {
  return bias_strips(dy, caps).total * static_cast<uint64_t>(blocks4(dy.shape[1])) * 16;
}

void record_bias_gradient(Recorder& recorder, const TensorSpec& dy_spec, Slice dy, Slice db,
                          uint32_t accumulate, Slice scratch) {
  const BiasStrips strips = bias_strips(dy_spec, recorder.caps());
  const Shape& shape = dy_spec.shape;
  const auto co4 = static_cast<uint32_t>(blocks4(shape[1]));
  const Slice partial = scratch.sub(0, bias_gradient_scratch(dy_spec, recorder.caps()));
  const StripPush push{.images = static_cast<uint32_t>(shape[0]),
                       .co4 = co4,
                       .image = static_cast<uint32_t>(shape[2] * shape[3]),
                       .strip_images = strips.images,
                       .image_strips = strips.per_image,
                       .strip_pixels = strips.pixels};
  recorder.dispatch("bias_gradient.strip", {strips.lanes}, {dy, partial}, push, {co4, strips.total, 1});
  recorder.dispatch_flat("bias_gradient.sum", co4, {partial, db},
                         SumPush{static_cast<uint32_t>(shape[1]), co4, strips.total, accumulate});
}

}  // namespace vkopple
