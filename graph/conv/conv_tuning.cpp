#include "graph/conv/conv_tuning.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace vkopple {
namespace {

using Numbers = std::vector<uint32_t>;

const Numbers* find(const std::string& key, const Caps& caps) {
  if (caps.tuned == nullptr) return nullptr;
  const auto found = caps.tuned->find(key);
  return found == caps.tuned->end() ? nullptr : &found->second;
}

std::optional<SharedTile> shared_tile(const Numbers& n, const Caps& caps) {
  if (n.size() != 5) return std::nullopt;
  const SharedTile tile{.out4 = n[0], .pixels = n[1], .across = n[2], .down = n[3], .depth = n[4]};
  return fits(tile, caps) ? std::optional(tile) : std::nullopt;
}

std::optional<SharedGradientTile> shared_gradient_tile(const Numbers& n, const Caps& caps) {
  if (n.size() != 5) return std::nullopt;
  const SharedGradientTile tile{.rows4 = n[0], .columns4 = n[1], .across = n[2], .down = n[3], .depth = n[4]};
  return fits(tile, caps) ? std::optional(tile) : std::nullopt;
}

std::optional<CooperativeTile> cooperative_tile(const Numbers& n, CooperativeUse use, const Caps& caps) {
  if (n.size() != 8) return std::nullopt;
  const CooperativeTile tile{
      .matrix = {n[0], n[1], n[2]}, .rows = n[3], .columns = n[4], .down = n[5], .across = n[6], .depth = n[7]};
  return fits(tile, use, caps) ? std::optional(tile) : std::nullopt;
}

std::optional<ConvTile> conv_tile(const Numbers& n) {
  const auto is_size = [](uint32_t v) { return v == 1 || v == 2 || v == 4 || v == 8; };
  if (n.size() != 2 || !is_size(n[0]) || !is_size(n[1])) return std::nullopt;
  return ConvTile{.out4 = n[0], .pixels = n[1]};
}

/// Weights are packed for no more than 8 or 16 channels where there are no more (conv_product.cpp), and tiles
/// of a single vector are for 4.
bool suits(const ConvTile& tile, int64_t out_channels) {
  const int64_t most = out_channels <= 8 ? 2 : (out_channels <= 16 ? 4 : 8);
  return tile.out4 <= most && (tile.out4 > 1 || out_channels <= 4);
}

void add(ConvTuning& tuning, Numbers numbers) {
  if (numbers != tuning.standard) tuning.candidates.push_back(std::move(numbers));
}

}  // namespace

std::string tuning_key(std::string_view kernel, const ConvShape& s, ConvStorage storage) {
  const auto name = [](Storage kind) { return kind == Storage::kFloat16 ? "float16" : "float32"; };
  return fmt::format("{} {}x{} stride {} padding {} dilation {}, {}x{}x{}x{} {} to {}x{}x{} {}", kernel,
                     s.kernel, s.kernel, s.stride, s.padding, s.dilation, s.n, s.ci, s.h, s.w, name(storage.x),
                     s.co, s.ho, s.wo, name(storage.y));
}

bool is_tuned_choice(std::string_view key, const Numbers& numbers, const Caps& caps) {
  const std::string_view kernel = key.substr(0, key.find(' '));
  if (kernel == kShuffleForward || kernel == kShuffleTransposed) return conv_tile(numbers).has_value();
  if (kernel == kSharedForward || kernel == kSharedTransposed) return shared_tile(numbers, caps).has_value();
  if (kernel == kSharedGradient) return shared_gradient_tile(numbers, caps).has_value();
  if (kernel == kCooperativeForward || kernel == kCooperativeTransposed)
    return cooperative_tile(numbers, CooperativeUse::kProduct, caps).has_value();
  if (kernel == kCooperativeGradient)
    return cooperative_tile(numbers, CooperativeUse::kWeightGradient, caps).has_value();
  return false;
}

std::optional<SharedTile> tuned_shared_tile(const std::string& key, const Caps& caps) {
  const Numbers* numbers = find(key, caps);
  return numbers == nullptr ? std::nullopt : shared_tile(*numbers, caps);
}

std::optional<SharedGradientTile> tuned_shared_gradient_tile(const std::string& key, const Caps& caps) {
  const Numbers* numbers = find(key, caps);
  return numbers == nullptr ? std::nullopt : shared_gradient_tile(*numbers, caps);
}

std::optional<CooperativeTile> tuned_cooperative_tile(const std::string& key, CooperativeUse use,
                                                      const Caps& caps) {
  const Numbers* numbers = find(key, caps);
  return numbers == nullptr ? std::nullopt : cooperative_tile(*numbers, use, caps);
}

std::optional<ConvTile> tuned_conv_tile(const std::string& key, int64_t out_channels, const Caps& caps) {
  const Numbers* numbers = find(key, caps);
  const auto tile = numbers == nullptr ? std::nullopt : conv_tile(*numbers);
  return tile && suits(*tile, out_channels) ? tile : std::nullopt;
}

Numbers numbers_of(const SharedTile& t) { return {t.out4, t.pixels, t.across, t.down, t.depth}; }
Numbers numbers_of(const SharedGradientTile& t) { return {t.rows4, t.columns4, t.across, t.down, t.depth}; }
Numbers numbers_of(const CooperativeTile& t) {
  return {t.matrix.m, t.matrix.n, t.matrix.k, t.rows, t.columns, t.down, t.across, t.depth};
}
Numbers numbers_of(const ConvTile& t) {
  return {static_cast<uint32_t>(t.out4), static_cast<uint32_t>(t.pixels)};
}

ConvTuning shared_tuning(std::string key, const SharedTile& standard, const Caps& caps) {
  ConvTuning tuning{.key = std::move(key), .standard = numbers_of(standard), .candidates = {}};
  for (SharedTile tile : shared_tiles())
    for (const uint32_t depth : {1U, 2U, 4U}) {
      tile.depth = depth;
      if (fits(tile, caps)) add(tuning, numbers_of(tile));
    }
  return tuning;
}

ConvTuning shared_gradient_tuning(std::string key, const SharedGradientTile& standard, const Caps& caps) {
  ConvTuning tuning{.key = std::move(key), .standard = numbers_of(standard), .candidates = {}};
  for (SharedGradientTile tile : shared_gradient_tiles())
    for (const uint32_t depth : {4U, 8U, 16U}) {
      tile.depth = depth;
      if (fits(tile, caps)) add(tuning, numbers_of(tile));
    }
  return tuning;
}

ConvTuning register_tuning(std::string key, const ConvTile& standard, int64_t out_channels) {
  ConvTuning tuning{.key = std::move(key), .standard = numbers_of(standard), .candidates = {}};
  for (const ConvTile& tile : conv_tiles())
    if (suits(tile, out_channels)) add(tuning, numbers_of(tile));
  return tuning;
}

}  // namespace vkopple
