#include "graph/conv/conv_shared.h"

#include <algorithm>

#include "graph/conv/shared_tile.h"
#include "graph/tensor.h"

namespace vkopple {
namespace {

/// As conv_shared_pack.comp has it.
struct PackPush {
  int32_t out_channels, in_channels, taps;
  int32_t transposed, has_bias;
  int32_t weight_vectors, weight_invocations, invocations;
};

/// As conv_shared.comp has it.
struct SharedPush {
  ProductPush product;
  uint32_t accumulate;
};

/// What the product makes and reads, and how its weights are packed.
struct Packed {
  int64_t in, out, taps;

  Packed(const ConvShape& shape, ConvDirection direction)
      : in(channels_of(shape, direction).in),
        out(channels_of(shape, direction).out),
        taps(shape.kernel * shape.kernel) {}
  int64_t tap_vectors() const { return 4 * blocks4(in) * blocks4(out); }
  int64_t weight_vectors() const { return taps * tap_vectors(); }
  uint64_t bytes() const { return static_cast<uint64_t>(weight_vectors() + blocks4(out)) * 16; }
};

void record_pack(Recorder& recorder, const Packed& packed, ConvDirection direction,
                 const ConvOperands& operands, const Slice& to) {
  const int64_t invocations = packed.tap_vectors() + blocks4(packed.out);
  const PackPush push{.out_channels = static_cast<int32_t>(packed.out),
                      .in_channels = static_cast<int32_t>(packed.in),
                      .taps = static_cast<int32_t>(packed.taps),
                      .transposed = direction == ConvDirection::kTransposed ? 1 : 0,
                      .has_bias = operands.bias ? 1 : 0,
                      .weight_vectors = static_cast<int32_t>(packed.weight_vectors()),
                      .weight_invocations = static_cast<int32_t>(packed.tap_vectors()),
                      .invocations = static_cast<int32_t>(invocations)};
  recorder.dispatch_flat("conv_shared_pack", static_cast<uint64_t>(invocations),
                         {operands.w, operands.bias, to}, push);
}

SharedWork work_of(const ProductPush& push) {
  return {.pixels = phase_pixels(push),
          .phases = int64_t{push.phases} * push.phases,
          .out4 = push.out4,
          .in4 = push.in4};
}

std::string key_of(const ConvShape& shape, ConvDirection direction, ConvStorage storage) {
  return tuning_key(direction == ConvDirection::kForward ? kSharedForward : kSharedTransposed, shape, storage);
}

}  // namespace

bool can_conv_shared(const Caps& caps) {
  const auto tiles = shared_tiles();
  return std::any_of(tiles.begin(), tiles.end(), [&](const SharedTile& tile) { return fits(tile, caps); });
}

uint64_t conv_shared_scratch(const ConvShape& shape, ConvDirection direction) {
  return Packed(shape, direction).bytes();
}

ConvTuning conv_shared_tuning(const ConvShape& shape, ConvDirection direction, const ProductPush& push,
                              const Caps& caps, ConvStorage storage) {
  return shared_tuning(key_of(shape, direction, storage), choose_shared_tile(work_of(push), caps), caps);
}

void record_conv_shared(Recorder& recorder, const ConvShape& shape, ConvDirection direction, ProductPush push,
                        const ConvOperands& operands, const Slice& scratch) {
  const Caps& caps = recorder.caps();
  const Packed packed(shape, direction);
  const Slice weights = scratch.sub(0, packed.bytes());
  record_pack(recorder, packed, direction, operands, weights);

  const SharedWork work = work_of(push);
  const auto tuned = tuned_shared_tile(key_of(shape, direction, operands.storage(direction)), caps);
  const SharedTile tile = tuned ? *tuned : choose_shared_tile(work, caps);
  push.bias = static_cast<int32_t>(packed.weight_vectors());
  push.tiles = static_cast<int32_t>((4 * work.out4 + tile.tile_channels() - 1) / tile.tile_channels());
  const int64_t tiles = (work.pixels + tile.tile_pixels() - 1) / tile.tile_pixels() * push.tiles;
  recorder.dispatch("conv_shared",
                    {tile.invocations(), tile.out4, tile.pixels, tile.across, tile.down, tile.depth,
                     caps.exact_sums ? 1U : 0U},
                    {operands.in, weights, operands.out}, SharedPush{push, operands.accumulate},
                    phase_groups(tiles, work.phases, caps));
}

}  // namespace vkopple
