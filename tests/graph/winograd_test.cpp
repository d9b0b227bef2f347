#include "graph/conv/winograd.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "graph/conv/convolution.h"
#include "graph/conv/winograd_chunks.h"
#include "graph/tensor.h"
#include "runtime/transfer.h"
#include "tests/support/conv_reference.h"
#include "tests/support/expect_error.h"
#include "tests/support/guarded.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using Values = std::vector<float>;
using Doubles = std::vector<double>;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Errors that a kernel may make, relative to the root mean square of the exact values.
struct Limits {
  double rms, worst;
};

/// Winograd's transforms enlarge what is rounded between them. The algorithms carried out with NumPy in
/// float32, one rounding an operation, on operands drawn as here (64 channels, up to 3,000 tiles) err by 2.8e-7
/// (2 x 2) and 8.6e-7 (4 x 4), at worst by 1.4e-6 and 8.2e-6, where a direct sum errs by 4.4e-7. The limits are
/// between 2 and 3 times as much.
Limits product_limits(WinogradTile tile) {
  return tile == WinogradTile::k4 ? Limits{2e-6, 2e-5} : Limits{8e-7, 4e-6};
}

/// Likewise for sums over tiles, 512 at a time: 7e-7 and 2.2e-6, at worst 2.7e-6 and 1.1e-5.
Limits weight_gradient_limits(WinogradTile tile) {
  return tile == WinogradTile::k4 ? Limits{4e-6, 3e-5} : Limits{1.6e-6, 8e-6};
}

const char* kernel_of(WinogradTile tile) { return tile == WinogradTile::k4 ? "winograd4" : "winograd2"; }

ConvShape shape_of(int64_t n, int64_t ci, int64_t h, int64_t w, int64_t co, int64_t padding) {
  return {.n = n,
          .ci = ci,
          .h = h,
          .w = w,
          .co = co,
          .ho = h + 2 * padding - 2,
          .wo = w + 2 * padding - 2,
          .kernel = 3,
          .stride = 1,
          .padding = padding,
          .dilation = 1};
}

Values draw(int64_t count, uint32_t seed) {
  std::mt19937 random(seed);
  Values values(static_cast<size_t>(count));
  for (float& v : values) v = static_cast<float>(random() % 2001) / 1000.0F - 1.0F;
  return values;
}

void expect_close(const Values& got, const Doubles& want, const Limits& limits) {
  ASSERT_EQ(got.size(), want.size());
  double square = 0;
  double error2 = 0;
  double worst = 0;
  for (size_t i = 0; i < want.size(); ++i) {
    const double d = std::abs(static_cast<double>(got[i]) - want[i]);
    square += want[i] * want[i];
    error2 += d * d;
    if (!(d <= worst)) worst = d;
  }
  const double rms = std::sqrt(square / static_cast<double>(want.size())) + 1e-30;
  EXPECT_LE(std::sqrt(error2 / static_cast<double>(want.size())) / rms, limits.rms);
  EXPECT_LE(worst / rms, limits.worst);
}

/// A shape's operands on a device, and what its products should be.
class Problem {
 public:
  Problem(const Device& device, const ConvShape& s)
      : device_(device),
        s_(s),
        x_spec_(channels4({s.n, s.ci, s.h, s.w})),
        y_spec_(channels4({s.n, s.co, s.ho, s.wo})),
        w_spec_(row_major({s.co, s.ci, 3, 3})),
        x_(draw(x_spec_.shape.elements(), 1)),
        y_(draw(y_spec_.shape.elements(), 2)),
        w_(draw(w_spec_.shape.elements(), 3)),
        memory_(device) {}

  /// Onto NaN with a bias, then added to what that left.
  void check_product(ConvDirection direction, WinogradTile tile) {
    const bool forward = direction == ConvDirection::kForward;
    const TensorSpec& out_spec = forward ? y_spec_ : x_spec_;
    const Values bias = draw(out_spec.shape[1], 4);
    const auto plane = static_cast<size_t>(out_spec.shape[2] * out_spec.shape[3]);
    Doubles want(static_cast<size_t>(out_spec.shape.elements()));
    for (size_t i = 0; i < want.size(); ++i) want[i] = static_cast<double>(bias[i / plane % bias.size()]);
    test::each_product(s_, [&](size_t x, size_t w, size_t y) {
      want[forward ? y : x] += static_cast<double>(forward ? x_[x] : y_[y]) * static_cast<double>(w_[w]);
    });
    const Slice out = place(Values(out_spec.bytes() / 4, kNaN));
    ConvOperands operands{.in = forward ? place(to_layout(x_spec_, x_)) : place(to_layout(y_spec_, y_)),
                          .w = place(w_),
                          .bias = place(bias),
                          .out = out};
    const Slice scratch = scratch_of(convolution_scratch(s_, direction, device_.caps(), kernel_of(tile)));
    for (const uint32_t accumulate : {0U, 1U}) {
      operands.accumulate = accumulate;
      Recorder recorder(device_, false, Bounds::kGuarded);
      record_convolution(recorder, s_, direction, operands, scratch, kernel_of(tile));
      test::run_guarded(recorder, memory_);
      if (accumulate == 1)
        for (double& v : want) v *= 2;
      expect_close(from_layout(out_spec, download_values<float>(device_, out)), want, product_limits(tile));
    }
  }

  void check_weight_gradient(WinogradTile tile) {
    Doubles want(w_.size());
    test::each_product(s_, [&](size_t x, size_t w, size_t y) {
      want[w] += static_cast<double>(x_[x]) * static_cast<double>(y_[y]);
    });
    const Slice x = place(to_layout(x_spec_, x_));
    const Slice dy = place(to_layout(y_spec_, y_));
    const Slice dw = place(Values(w_.size(), kNaN));
    const Slice scratch = scratch_of(convolution_weight_gradient_scratch(s_, device_.caps(), kernel_of(tile)));
    for (const uint32_t accumulate : {0U, 1U}) {
      Recorder recorder(device_, false, Bounds::kGuarded);
      record_convolution_weight_gradient(recorder, s_, x, dy, dw, accumulate, scratch, kernel_of(tile));
      test::run_guarded(recorder, memory_);
      if (accumulate == 1)
        for (double& v : want) v *= 2;
      auto got = download_values<float>(device_, dw);
      got.resize(w_.size());
      expect_close(got, want, weight_gradient_limits(tile));
    }
  }

 private:
  Slice place(const Values& values) {
    const Slice slice = memory_.allocate(values.size() * 4, "an operand");
    upload_values<float>(device_, slice, values);
    return slice;
  }
  Slice scratch_of(uint64_t bytes) { return place(Values(bytes / 4, kNaN)); }

  const Device& device_;
  ConvShape s_;
  TensorSpec x_spec_, y_spec_, w_spec_;
  Values x_, y_, w_;
  GuardedMemory memory_;
};

void check_shape(const Device& device, const ConvShape& s) {
  for (const WinogradTile tile : {WinogradTile::k2, WinogradTile::k4}) {
    if (!can_winograd(s, tile, device.caps())) {
      std::cout << "left out, " << device.caps().name << " has no shuffles\n";
      return;
    }
    SCOPED_TRACE(fmt::format("{}: {} images, {} x {} x {} -> {}, padding {}", kernel_of(tile), s.n, s.ci, s.h,
                             s.w, s.co, s.padding));
    Problem problem(device, s);
    problem.check_product(ConvDirection::kForward, tile);
    problem.check_product(ConvDirection::kTransposed, tile);
    problem.check_weight_gradient(tile);
  }
}

TEST(WinogradTest, MatchesPlainLoops) {
  for (const ConvShape& s :
       {shape_of(3, 20, 17, 19, 72, 1), shape_of(2, 37, 9, 33, 16, 0), shape_of(40, 8, 3, 2, 9, 3)})
    check_shape(test_device(), s);
}

TEST(WinogradTest, MatchesPlainLoopsOnTheOtherAccessPath) {
  if (other_access_device() == nullptr) GTEST_SKIP() << missing_for(AccessPath::kTexel, test_device().caps());
  check_shape(*other_access_device(), shape_of(3, 20, 7, 9, 36, 1));
}

TEST(WinogradTest, MatchesPlainLoopsOverSeveralChunks) {
  const ConvShape s = shape_of(3, 4, 263, 250, 5, 1);
  for (const WinogradTile tile : {WinogradTile::k2, WinogradTile::k4}) {
    const WinogradChunks chunks = winograd_chunks(tile, s.n, s.h, s.w, 64, 3);
    EXPECT_LT(chunks.chunk_blocks, chunks.blocks());
  }
  check_shape(test_device(), s);
  // Channels of whole subgroups, whose weight gradient is stored by rows and added to from the second chunk on.
  check_shape(test_device(), shape_of(1, 64, 98, 98, 5, 1));
}

Caps cpu_caps() {
  Caps caps;
  caps.type = DeviceType::kCpu;
  caps.subgroup_size = 8;
  caps.subgroup_shuffle = true;
  caps.max_storage_range = 128 << 20;
  caps.max_texel_elements = 128 << 20;
  return caps;
}

TEST(ConvolutionChoiceTest, TakesWinogradWhereChannelsAndTilesAreMany) {
  const Caps caps = cpu_caps();
  const auto forward = [&](const ConvShape& s) { return choose_convolution(s, ConvDirection::kForward, caps); };
  EXPECT_EQ(forward(shape_of(4, 64, 128, 128, 64, 1)), ConvAlgorithm::kWinograd4);
  EXPECT_EQ(choose_weight_gradient(shape_of(4, 64, 128, 128, 64, 1), caps), ConvAlgorithm::kWinograd4);
  EXPECT_EQ(forward(shape_of(4, 3, 128, 128, 8, 1)), ConvAlgorithm::kDirect);
  EXPECT_EQ(forward(shape_of(1, 512, 2, 2, 512, 1)), ConvAlgorithm::kDirect);
  ConvShape strided = shape_of(4, 64, 128, 128, 64, 1);
  strided.stride = 2;
  strided.ho = strided.wo = 64;
  EXPECT_EQ(forward(strided), ConvAlgorithm::kDirect);
}

TEST(ConvolutionChoiceTest, StaysDirectWhereAskedTo) {
  const ConvShape s = shape_of(4, 64, 128, 128, 64, 1);
  const auto direct = [&](const Caps& caps) {
    EXPECT_EQ(choose_convolution(s, ConvDirection::kForward, caps), ConvAlgorithm::kDirect);
    EXPECT_EQ(choose_weight_gradient(s, caps), ConvAlgorithm::kDirect);
  };
  Caps caps = cpu_caps();
  caps.exact_sums = true;
  direct(caps);
  caps = cpu_caps();
  caps.winograd = WinogradUse::kNever;
  direct(caps);
  caps = cpu_caps();
  caps.subgroup_shuffle = false;
  direct(caps);
  test::expect_error([&] { choose_convolution(s, ConvDirection::kForward, caps, "winograd4"); },
                     {"winograd4", "leave the choice"});
  caps = cpu_caps();
  caps.type = DeviceType::kDiscrete;
  direct(caps);
}

}  // namespace
}  // namespace vkopple
