#include "train/exchange/colour_order.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr std::array<std::string_view, 3> kFirst{"depth_model.depth_net.inc.conv.0.weight",
                                                 "segmentation_model.seg_net.seg_net.inc.conv.0.weight",
                                                 "imagination_model.imag_net.imag_net.inc.conv.0.weight"};
constexpr std::array<std::string_view, 2> kLast{"imagination_model.imag_net.imag_net.outc.conv.weight",
                                                "imagination_model.imag_net.imag_net.outc.conv.bias"};
constexpr std::int64_t kRed = 0;
constexpr std::int64_t kBlue = 2;

/// Swaps entries 0 and 2 along an axis.
void swap_along(StoredTensor& tensor, std::size_t axis) {
  if (tensor.shape.size() <= axis || tensor.shape[axis] <= kBlue)
    throw Error("weights without a red and a blue channel");
  std::int64_t inner = static_cast<std::int64_t>(dtype_size(tensor.dtype));
  for (std::size_t i = axis + 1; i < tensor.shape.size(); ++i) inner *= tensor.shape[i];
  const std::int64_t block = inner * tensor.shape[axis];
  const auto end = static_cast<std::int64_t>(tensor.bytes.size());
  for (std::int64_t begin = 0; begin < end; begin += block) {
    const auto red = tensor.bytes.begin() + begin + kRed * inner;
    std::swap_ranges(red, red + inner, tensor.bytes.begin() + begin + kBlue * inner);
  }
}

}  // namespace

void swap_red_and_blue(std::map<std::string, StoredTensor>& tensors) {
  for (const std::string_view name : kFirst) swap_along(tensors.at(std::string(name)), 1);
  for (const std::string_view name : kLast) swap_along(tensors.at(std::string(name)), 0);
}

}  // namespace vkopple
