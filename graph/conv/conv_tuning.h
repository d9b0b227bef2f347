#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/conv/conv_shape.h"
#include "graph/conv/conv_tile.h"
#include "graph/conv/cooperative_tile.h"
#include "graph/conv/shared_tile.h"
#include "runtime/storage.h"

namespace vkopple {

/// What Caps::tuned may say about one product of one convolution.
struct ConvTuning {
  std::string key;
  std::vector<uint32_t> standard;                 ///< the tile that is taken otherwise
  std::vector<std::vector<uint32_t>> candidates;  ///< others worth a try; all of them run on the device
};

/// Kernels that have tiles to choose. The first word of a key.
constexpr std::string_view kShuffleForward = "conv_shuffle.forward";
constexpr std::string_view kShuffleTransposed = "conv_shuffle.transposed";
constexpr std::string_view kSharedForward = "conv_shared.forward";
constexpr std::string_view kSharedTransposed = "conv_shared.transposed";
constexpr std::string_view kSharedGradient = "weight_gradient_shared";
constexpr std::string_view kCooperativeForward = "conv_cooperative.forward";
constexpr std::string_view kCooperativeTransposed = "conv_cooperative.transposed";
constexpr std::string_view kCooperativeGradient = "weight_gradient_cooperative";

/// How a convolution's x and y, and their gradients with them, are stored; tiles are tuned for each by itself.
struct ConvStorage {
  Storage x = Storage::kFloat32;
  Storage y = Storage::kFloat32;
};

/// "conv_shared.forward 3x3 stride 1 padding 1 dilation 1, 4x64x128x128 float32 to 64x128x128 float16".
std::string tuning_key(std::string_view kernel, const ConvShape& shape, ConvStorage storage = {});

/// Whether the device can run the tile that these numbers describe, for the kernel that the key begins with.
bool is_tuned_choice(std::string_view key, const std::vector<uint32_t>& numbers, const Caps& caps);

/// The choice of Caps::tuned, if there is one that the device can run.
std::optional<SharedTile> tuned_shared_tile(const std::string& key, const Caps& caps);
std::optional<SharedGradientTile> tuned_shared_gradient_tile(const std::string& key, const Caps& caps);
std::optional<CooperativeTile> tuned_cooperative_tile(const std::string& key, CooperativeUse use,
                                                      const Caps& caps);
/// out_channels of the product; not every tile suits few of them.
std::optional<ConvTile> tuned_conv_tile(const std::string& key, int64_t out_channels, const Caps& caps);

std::vector<uint32_t> numbers_of(const SharedTile& tile);
std::vector<uint32_t> numbers_of(const SharedGradientTile& tile);
std::vector<uint32_t> numbers_of(const CooperativeTile& tile);
std::vector<uint32_t> numbers_of(const ConvTile& tile);

/// Tiles other than `standard` that fit.
ConvTuning shared_tuning(std::string key, const SharedTile& standard, const Caps& caps);
ConvTuning shared_gradient_tuning(std::string key, const SharedGradientTile& standard, const Caps& caps);
ConvTuning register_tuning(std::string key, const ConvTile& standard, int64_t out_channels);

}  // namespace vkopple
