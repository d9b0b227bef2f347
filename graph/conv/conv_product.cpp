#include "graph/conv/conv_product.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include "graph/conv/conv_cooperative.h"
#include "graph/conv/conv_push.h"
#include "graph/conv/conv_shared.h"
#include "graph/conv/conv_tile.h"
#include "graph/conv/conv_window.h"
#include "graph/conv/cooperative_tile.h"
#include "graph/tensor.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr std::string_view kShuffle = "shuffle";
constexpr std::string_view kUniform = "uniform";
constexpr std::string_view kShared = "shared";
constexpr std::string_view kCooperative = "cooperative";
constexpr std::string_view kWindow = "window";

/// As conv_pack.comp has it.
struct PackPush {
  int32_t out_channels, in_channels, taps;
  int32_t transposed, has_bias;
  int32_t weight_vectors, weight_invocations, invocations;
};

/// Output channels that weights and bias are packed for: whole tiles, of any size that could be chosen.
int64_t packed_channels(int64_t channels) {
  for (const int64_t most : {8, 16})
    if (channels <= most) return most;
  return (channels + kMostTileChannels - 1) / kMostTileChannels * kMostTileChannels;
}

/// Weights and bias packed for a product.
class Packing {
 public:
  Packing(const ConvShape& shape, ConvDirection direction)
      : transposed_(direction == ConvDirection::kTransposed) {
    const auto [in, out] = channels_of(shape, direction);
    in_ = in;
    out_ = out;
    taps_ = shape.kernel * shape.kernel;
    vectors_ = packed_channels(out) * taps_ * blocks4(in);
  }
  /// Where the bias starts.
  int64_t weight_vectors() const { return vectors_; }
  uint64_t bytes() const { return static_cast<uint64_t>(vectors_ + packed_channels(out_) / 4) * 16; }

  void record(Recorder& recorder, const ConvOperands& operands, const Slice& packed) const {
    const bool whole = (transposed_ ? out_ : in_) % 4 == 0;  // w is read in vectors
    const int64_t weights = !whole ? vectors_ : vectors_ / taps_ / (transposed_ ? 4 : 1);
    const int64_t invocations = weights + packed_channels(out_) / 4;
    const PackPush push{.out_channels = static_cast<int32_t>(out_),
                        .in_channels = static_cast<int32_t>(in_),
                        .taps = static_cast<int32_t>(taps_),
                        .transposed = transposed_ ? 1 : 0,
                        .has_bias = operands.bias ? 1 : 0,
                        .weight_vectors = static_cast<int32_t>(vectors_),
                        .weight_invocations = static_cast<int32_t>(weights),
                        .invocations = static_cast<int32_t>(invocations)};
    const std::vector<uint32_t> constants =
        whole ? std::vector{static_cast<uint32_t>(taps_)} : std::vector<uint32_t>{};
    const char* shader =
        !whole ? "conv_pack.any" : (transposed_ ? "conv_pack.transposed" : "conv_pack.forward");
    recorder.dispatch_flat(shader, static_cast<uint64_t>(invocations), {operands.w, operands.bias, packed},
                           push, constants);
  }

 private:
  bool transposed_;
  int64_t in_ = 0, out_ = 0, taps_ = 0;
  int64_t vectors_ = 0;
};

/// Leaves out taps that read no input for any of the `outputs` rows or columns of a phase: at wide dilations of
/// small images that is most of them.
void drop_outside_taps(ProductPush& push, int phase, int64_t outputs, int64_t inputs) {
  const auto reaches = [&](int64_t base) { return base < inputs && base + (outputs - 1) * push.stride >= 0; };
  while (push.taps[phase] > 0 && !reaches(push.base[phase])) {
    push.base[phase] += push.step;
    push.first[phase] += push.tap_step;
    --push.taps[phase];
  }
  while (push.taps[phase] > 0 && !reaches(push.base[phase] + (push.taps[phase] - 1) * push.step))
    --push.taps[phase];
}

void set_forward_taps(ProductPush& push, const ConvShape& s) {
  push.stride = static_cast<int32_t>(s.stride);
  push.step = static_cast<int32_t>(s.dilation);
  push.tap_step = 1;
  push.phases = 1;
  push.taps[0] = static_cast<int32_t>(s.kernel);
  push.base[0] = static_cast<int32_t>(-s.padding);
}

/// x row xi = phases · row + a receives y row yo of tap ky where xi = yo · stride + ky · dilation − padding, so
/// where (a + padding − ky · dilation) is a multiple of the stride, which is `phases`.
void set_transposed_taps(ProductPush& push, const ConvShape& s) {
  push.stride = 1;
  push.phases = static_cast<int32_t>(s.stride);
  const bool every_tap = s.dilation % s.stride == 0;  // of one phase, the others having none
  push.tap_step = every_tap ? 1 : push.phases;
  push.step = static_cast<int32_t>(-push.tap_step * s.dilation / s.stride);
  for (int64_t a = 0; a < s.stride; ++a) {
    int64_t first = 0;
    while (first < push.tap_step && (a + s.padding - first * s.dilation) % s.stride != 0) ++first;
    const bool none = first == push.tap_step;
    push.first[a] = static_cast<int32_t>(none ? 0 : first);
    push.taps[a] = none ? 0 : static_cast<int32_t>((s.kernel - first + push.tap_step - 1) / push.tap_step);
    push.base[a] = none ? 0 : static_cast<int32_t>((a + s.padding - first * s.dilation) / s.stride);
  }
}

ProductPush product_push(const ConvShape& s, ConvDirection direction) {
  const bool forward = direction == ConvDirection::kForward;
  const auto [in, out] = channels_of(s, direction);
  ProductPush push{};
  push.n = static_cast<int32_t>(s.n);
  push.in4 = static_cast<int32_t>(blocks4(in));
  push.out4 = static_cast<int32_t>(blocks4(out));
  push.h = static_cast<int32_t>(forward ? s.h : s.ho);
  push.w = static_cast<int32_t>(forward ? s.w : s.wo);
  push.out_h = static_cast<int32_t>(forward ? s.ho : s.h);
  push.out_w = static_cast<int32_t>(forward ? s.wo : s.w);
  push.kernel = static_cast<int32_t>(s.kernel);
  if (forward)
    set_forward_taps(push, s);
  else
    set_transposed_taps(push, s);
  // Rows and columns share their taps: a tap is dropped where it is outside in both directions.
  for (int a = 0; a < push.phases; ++a) {
    const int64_t outputs = (std::max(push.out_h, push.out_w) - a + push.phases - 1) / push.phases;
    drop_outside_taps(push, a, outputs, std::max(push.h, push.w));
  }
  return push;
}

std::string_view chosen_kernel(std::string_view kernel, const ConvShape& shape, ConvDirection direction,
                               Storage in, const Caps& caps) {
  if (kernel.empty()) {
    if (caps.kernels == KernelFamily::kPlain) return kUniform;
    if (prefers_cooperative(shape, CooperativeUse::kProduct, in == Storage::kFloat16, caps))
      return kCooperative;
    if (caps.kernels == KernelFamily::kShared || caps.kernels == KernelFamily::kCooperative) return kShared;
    const bool registers = caps.cpu() || caps.kernels == KernelFamily::kRegisters;
    if (registers && prefers_conv_window(shape, direction, caps)) return kWindow;
    if (registers) return can_run_conv_kernel(kShuffle, caps) ? kShuffle : kUniform;
    return can_run_conv_kernel(kShared, caps) ? kShared : kUniform;
  }
  if (!can_run_conv_kernel(kernel, caps) || (kernel == kWindow && !can_conv_window(shape, caps)))
    throw Error(fmt::format(
        "convolution kernel '{}' can't run a {}x{} convolution on {}; leave the choice to the device", kernel,
        shape.kernel, shape.kernel, caps.name));
  return kernel;
}

ConvWork work_of(const ProductPush& push, int64_t out_channels, int64_t lanes) {
  double taps = 0;  // in one direction, summed over phases
  for (int a = 0; a < push.phases; ++a) taps += push.taps[a];
  const double phases = push.phases;
  return {.pixels = int64_t{push.n} * push.out_h * push.out_w,
          .out_channels = out_channels,
          .in4 = push.in4,
          .taps = taps * taps / (phases * phases),
          .lanes = lanes};
}

ConvTile standard_shuffle_tile(const ProductPush& push, int64_t out_channels, const Caps& caps) {
  return choose_shuffle_tile(work_of(push, out_channels, caps.subgroup_size),
                             std::max(1U, std::thread::hardware_concurrency()));
}

std::string shuffle_key(const ConvShape& shape, ConvDirection direction, ConvStorage storage) {
  return tuning_key(direction == ConvDirection::kForward ? kShuffleForward : kShuffleTransposed, shape,
                    storage);
}

/// Vectors of input channels that a kernel takes in straight code instead of a loop: all or (0) none. Loops
/// copy every sum, and long code is slow (limit measured on lavapipe).
uint32_t straight_vectors(const ProductPush& push, const ConvTile& tile) {
  constexpr int64_t kMost = 32;
  const bool straight = push.in4 == 1 || push.in4 * tile.out4 * tile.pixels <= kMost;
  return straight ? static_cast<uint32_t>(push.in4) : 0;
}

}  // namespace

bool is_conv_kernel(std::string_view kernel) {
  return kernel.empty() || kernel == kShuffle || kernel == kUniform || kernel == kShared ||
         kernel == kCooperative || kernel == kWindow;
}

bool can_run_conv_kernel(std::string_view kernel, const Caps& caps) {
  if (kernel == kShuffle) return caps.subgroup_shuffle && caps.subgroup_size >= 8 && caps.subgroup_size <= 128;
  if (kernel == kShared) return can_conv_shared(caps);
  if (kernel == kCooperative) return can_cooperative(CooperativeUse::kProduct, caps);
  if (kernel == kWindow) return can_conv_window(caps);
  return is_conv_kernel(kernel);
}

uint64_t conv_product_scratch(const ConvShape& shape, ConvDirection direction) {
  // Whichever family runs.
  return std::max({Packing(shape, direction).bytes(), conv_shared_scratch(shape, direction),
                   conv_cooperative_scratch(shape, direction)});
}

std::optional<ConvTuning> conv_product_tuning(const ConvShape& shape, ConvDirection direction, const Caps& caps,
                                              ConvStorage storage) {
  const bool forward = direction == ConvDirection::kForward;
  const std::string_view family = chosen_kernel({}, shape, direction, forward ? storage.x : storage.y, caps);
  const ProductPush push = product_push(shape, direction);
  if (family == kShared) return conv_shared_tuning(shape, direction, push, caps, storage);
  if (family != kShuffle) return std::nullopt;
  const int64_t out = channels_of(shape, direction).out;
  return register_tuning(shuffle_key(shape, direction, storage), standard_shuffle_tile(push, out, caps), out);
}

void record_conv_product(Recorder& recorder, const ConvShape& shape, ConvDirection direction,
                         const ConvOperands& operands, Slice scratch, std::string_view kernel) {
  const Caps& caps = recorder.caps();
  const std::string_view family = chosen_kernel(kernel, shape, direction, operands.in.storage, caps);
  ProductPush push = product_push(shape, direction);
  if (family == kShared) return record_conv_shared(recorder, shape, direction, push, operands, scratch);
  if (family == kCooperative)
    return record_conv_cooperative(recorder, shape, direction, push, operands, scratch);
  const Packing packing(shape, direction);
  const Slice packed = scratch.sub(0, packing.bytes());
  packing.record(recorder, operands, packed);
  if (family == kWindow)
    return record_conv_window(recorder, shape, direction, operands, packed, packing.weight_vectors(),
                              choose_window_tile(shape, direction, caps));
  const int64_t out = channels_of(shape, direction).out;
  const ConvWork work = work_of(push, out, family == kShuffle ? caps.subgroup_size : caps.flat_workgroup());
  const auto tuned =
      family == kShuffle
          ? tuned_conv_tile(shuffle_key(shape, direction, operands.storage(direction)), out, caps)
          : std::nullopt;
  const ConvTile tile = tuned                ? *tuned
                        : family == kShuffle ? standard_shuffle_tile(push, out, caps)
                                             : choose_uniform_tile(work);
  push.bias = static_cast<int32_t>(packing.weight_vectors());
  push.tiles = static_cast<int32_t>((push.out4 + tile.out4 - 1) / tile.out4);
  const bool rows = family == kShuffle && operands.accumulate == 0 && push.phases == 1 &&
                    push.out_h * push.out_w % caps.subgroup_size == 0 &&
                    row_stores_pay(push.taps[0] * push.taps[0] * push.in4, tile.out4 * tile.pixels, caps);
  const int64_t tile_pixels = work.lanes * tile.pixels;
  const Groups groups = phase_groups((phase_pixels(push) + tile_pixels - 1) / tile_pixels * push.tiles,
                                     int64_t{push.phases} * push.phases, caps);
  recorder.dispatch(
      "conv_product." + std::string(family),
      {static_cast<uint32_t>(work.lanes), static_cast<uint32_t>(tile.out4), static_cast<uint32_t>(tile.pixels),
       operands.accumulate, straight_vectors(push, tile), caps.exact_sums ? 1U : 0U, rows ? 1U : 0U},
      {operands.in, packed, operands.out}, push, groups);
}

}  // namespace vkopple
