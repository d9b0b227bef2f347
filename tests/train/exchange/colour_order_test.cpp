#include "train/exchange/colour_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/exchange_model.h"

namespace vkopple {
namespace {

constexpr const char* kDepth = "depth_model.depth_net.inc.conv.0.weight";
constexpr const char* kObject = "segmentation_model.seg_net.seg_net.inc.conv.0.weight";
constexpr const char* kImagination = "imagination_model.imag_net.imag_net.inc.conv.0.weight";
constexpr const char* kOut = "imagination_model.imag_net.imag_net.outc.conv.weight";
constexpr const char* kOutBias = "imagination_model.imag_net.imag_net.outc.conv.bias";

/// Channel `c` of weights (O, I, …) along an axis, all of it.
std::vector<float> channel(const StoredTensor& tensor, size_t axis, size_t c) {
  const std::vector<float> values = to_floats(tensor);
  size_t inner = 1;
  for (size_t i = axis + 1; i < tensor.shape.size(); ++i) inner *= static_cast<size_t>(tensor.shape[i]);
  const auto size = static_cast<size_t>(tensor.shape[axis]);
  std::vector<float> picked;
  for (size_t i = 0; i < values.size(); ++i)
    if (i / inner % size == c) picked.push_back(values[i]);
  return picked;
}

TEST(ColourOrder, SwapsRedAndBlueWhereImagesComeAndGo) {
  const auto before = test::drawn_weights().tensors;
  auto after = before;
  swap_red_and_blue(after);
  const std::map<std::string, size_t> axes{
      {kDepth, 1}, {kObject, 1}, {kImagination, 1}, {kOut, 0}, {kOutBias, 0}};
  for (const auto& [name, tensor] : before) {
    SCOPED_TRACE(name);
    const auto axis = axes.find(name);
    if (axis == axes.end()) {
      EXPECT_EQ(after.at(name).bytes, tensor.bytes);
      continue;
    }
    const std::vector<size_t> from{2, 1, 0, 3, 4};
    const auto channels = static_cast<size_t>(tensor.shape[axis->second]);
    for (size_t c = 0; c < channels; ++c)
      EXPECT_EQ(channel(after.at(name), axis->second, c), channel(tensor, axis->second, from[c])) << c;
  }
  swap_red_and_blue(after);
  for (const auto& [name, tensor] : before) EXPECT_EQ(after.at(name).bytes, tensor.bytes) << name;
}

}  // namespace
}  // namespace vkopple
