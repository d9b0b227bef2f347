#include "graph/conv/conv_cooperative.h"

#include <algorithm>

#include "graph/conv/conv_tuning.h"
#include "graph/tensor.h"

namespace vkopple {
namespace {

/// As conv_cooperative_pack.comp has it.
struct PackPush {
  int32_t out_channels, in_channels, taps;
  int32_t transposed;
  int32_t invocations;
};

/// As conv_cooperative.comp has it. product.bias is the number of channels that have one.
struct CooperativePush {
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
  int64_t tap_vectors() const { return 2 * ((in + 7) / 8) * 4 * blocks4(out); }
  uint64_t bytes() const {
    return static_cast<uint64_t>(4 * taps * tap_vectors()) * element_bytes(Storage::kFloat16);
  }
};

void record_pack(Recorder& recorder, const Packed& packed, ConvDirection direction, const Slice& w,
                 const Slice& to) {
  const PackPush push{.out_channels = static_cast<int32_t>(packed.out),
                      .in_channels = static_cast<int32_t>(packed.in),
                      .taps = static_cast<int32_t>(packed.taps),
                      .transposed = direction == ConvDirection::kTransposed ? 1 : 0,
                      .invocations = static_cast<int32_t>(packed.tap_vectors())};
  recorder.dispatch_flat("conv_cooperative_pack", static_cast<uint64_t>(packed.tap_vectors()), {w, to}, push);
}

CooperativeWork work_of(const ProductPush& push, const Packed& packed) {
  return {.rows = phase_pixels(push),
          .columns = packed.out,
          .summed = packed.in,
          .repeats = int64_t{push.phases} * push.phases};
}

}  // namespace

uint64_t conv_cooperative_scratch(const ConvShape& shape, ConvDirection direction) {
  return Packed(shape, direction).bytes();
}

void record_conv_cooperative(Recorder& recorder, const ConvShape& shape, ConvDirection direction,
                             ProductPush push, const ConvOperands& operands, const Slice& scratch) {
  const Caps& caps = recorder.caps();
  const Packed packed(shape, direction);
  Slice weights = scratch.sub(0, packed.bytes());
  weights.storage = Storage::kFloat16;
  record_pack(recorder, packed, direction, operands.w, weights);

  const CooperativeWork work = work_of(push, packed);
  const auto kernel = direction == ConvDirection::kForward ? kCooperativeForward : kCooperativeTransposed;
  const auto tuned = tuned_cooperative_tile(tuning_key(kernel, shape, operands.storage(direction)),
                                            CooperativeUse::kProduct, caps);
  const CooperativeTile tile = tuned ? *tuned : choose_cooperative_tile(work, CooperativeUse::kProduct, caps);
  push.bias = operands.bias ? static_cast<int32_t>(packed.out) : 0;
  push.tiles = static_cast<int32_t>((packed.out + tile.tile_columns() - 1) / tile.tile_columns());
  const int64_t tiles = (work.rows + tile.tile_rows() - 1) / tile.tile_rows() * push.tiles;
  recorder.dispatch("conv_cooperative",
                    {tile.subgroups() * caps.subgroup_size, tile.matrix.m, tile.matrix.n, tile.matrix.k,
                     tile.rows, tile.columns, tile.down, tile.across, tile.depth},
                    {operands.in, weights, operands.bias, operands.out},
                    CooperativePush{push, operands.accumulate}, phase_groups(tiles, work.repeats, caps));
}

}  // namespace vkopple
