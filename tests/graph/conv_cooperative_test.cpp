#include "graph/conv/conv_cooperative.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "graph/conv/conv_product.h"
#include "graph/conv/conv_tuning.h"
#include "graph/conv/weight_gradient.h"
#include "graph/float16.h"
#include "graph/tensor.h"
#include "runtime/device.h"
#include "runtime/transfer.h"
#include "tests/support/conv_reference.h"
#include "tests/support/guarded.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using Values = std::vector<float>;

/// Where the device has no cooperative matrices; tests say so and end.
std::string missing() { return missing_for(KernelFamily::kCooperative, test_device().caps()); }

Values rounded(Values values) {
  for (float& v : values) v = float16_value(float16_bits(v));
  return values;
}

/// Of three digits, so that float16 has to round most of them.
Values draw(const TensorSpec& spec, uint32_t seed) {
  std::mt19937 random(seed);
  Values values(static_cast<size_t>(spec.shape.elements()));
  for (float& v : values) v = static_cast<float>(random() % 2001) / 1000.0F - 1.0F;
  return values;
}

Slice place(const Device& device, GuardedMemory& memory, const TensorSpec& spec, const Values& values) {
  Slice slice = memory.allocate(spec.bytes(), "an operand");
  slice.storage = spec.storage;
  upload_values<float>(device, slice, to_layout(spec, values));
  return slice;
}

/// Sums in double precision, with what bounds the error of the same sums in float32.
class Sums {
 public:
  explicit Sums(size_t count) : value_(count, 0.0), size_(count, 0.0), terms_(count, 2.0) {}
  void add(size_t at, double term) {
    value_[at] += term;
    size_[at] += std::abs(term);
    terms_[at] += 1;
  }
  /// Expects every element within the error that a device may make: products of float16 are exact in float32
  /// (22 digits); each term may then round, or be cut off as matrix units do, by 2^-23 of what has been summed;
  /// and the result by its storage.
  void expect(const Values& got, Storage storage) const {
    const double stored = storage == Storage::kFloat16 ? kFloat16Roundoff : 0.0;
    ASSERT_EQ(got.size(), value_.size());
    for (size_t i = 0; i < got.size(); ++i) {
      const double summed = terms_[i] * std::ldexp(1.0, -23) * size_[i];
      const double limit = summed + stored * (std::abs(value_[i]) + summed) + std::ldexp(1.0, -25);
      ASSERT_LE(std::abs(static_cast<double>(got[i]) - value_[i]), limit)
          << "element " << i << " is " << got[i] << " and should be " << value_[i];
    }
  }

 private:
  std::vector<double> value_, size_, terms_;
};

double product(float a, float b) { return static_cast<double>(a) * static_cast<double>(b); }

/// A product, its operands and what it should make: operands rounded to float16 are taken as given.
class Problem {
 public:
  Problem(const Device& device, const ConvShape& s, ConvDirection direction, Storage storage)
      : device_(device),
        shape_(s),
        direction_(direction),
        memory_(device),
        w_spec_(row_major({s.co, s.ci, s.kernel, s.kernel})) {
    const bool forward = direction == ConvDirection::kForward;
    const TensorSpec x = channels4({s.n, s.ci, s.h, s.w});
    const TensorSpec y = channels4({s.n, s.co, s.ho, s.wo});
    in_spec_ = stored_as(forward ? x : y, storage);
    out_spec_ = stored_as(forward ? y : x, storage);
    bias_spec_ = row_major({out_spec_.shape[1]});
    in_ = draw(in_spec_, 1);
    w_ = draw(w_spec_, 2);
    bias_ = draw(bias_spec_, 3);
    before_ = storage == Storage::kFloat16 ? rounded(draw(out_spec_, 4)) : draw(out_spec_, 4);
  }

  Values run(std::string_view kernel, uint32_t accumulate, bool has_bias = true) {
    const ConvOperands operands{.in = place(device_, memory_, in_spec_, in_),
                                .w = place(device_, memory_, w_spec_, w_),
                                .bias = has_bias ? place(device_, memory_, bias_spec_, bias_) : Slice{},
                                .out = place(device_, memory_, out_spec_, before_),
                                .accumulate = accumulate};
    Recorder recorder(device_, false, Bounds::kGuarded);
    record_conv_product(recorder, shape_, direction_, operands,
                        memory_.allocate(conv_product_scratch(shape_, direction_), "scratch"), kernel);
    test::run_guarded(recorder, memory_);
    const Values words = download_values<float>(device_, operands.out);
    require_zero_padding(words);
    return from_layout(out_spec_, words);
  }

  void expect(const Values& got, bool accumulates, bool has_bias = true) const {
    Sums sums(got.size());
    const Values in = rounded(in_);
    const Values w = rounded(w_);
    const auto plane = static_cast<size_t>(out_spec_.shape[2] * out_spec_.shape[3]);
    for (size_t i = 0; i < got.size(); ++i) {
      if (accumulates) sums.add(i, static_cast<double>(before_[i]));
      if (has_bias) sums.add(i, static_cast<double>(bias_[i / plane % bias_.size()]));
    }
    test::each_product(shape_, [&](size_t x, size_t wi, size_t y) {
      const bool forward = direction_ == ConvDirection::kForward;
      sums.add(forward ? y : x, product(in[forward ? x : y], w[wi]));
    });
    sums.expect(got, out_spec_.storage);
  }

 private:
  void require_zero_padding(const Values& words) const {
    const TensorSpec plain = stored_as(out_spec_, Storage::kFloat32);
    const Values stored = out_spec_.storage == Storage::kFloat16 ? from_float16(words) : words;
    EXPECT_EQ(to_layout(plain, from_layout(plain, stored)), stored) << "padding lanes";
  }

  const Device& device_;
  ConvShape shape_;
  ConvDirection direction_;
  GuardedMemory memory_;
  TensorSpec in_spec_, w_spec_, bias_spec_, out_spec_;
  Values in_, w_, bias_, before_;
};

/// n, ci, h, w, co, ho, wo, kernel, stride, padding, dilation: single pixels and channels, several tiles each
/// way, ends within a matrix and within a vector, taps without pixels, phases without taps.
const std::vector<ConvShape>& shapes() {
  static const std::vector<ConvShape> all{
      {1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1},     {3, 5, 1, 1, 7, 1, 1, 3, 1, 1, 1},
      {2, 20, 9, 11, 40, 9, 11, 3, 1, 1, 1}, {2, 37, 11, 13, 16, 6, 7, 3, 2, 1, 1},
      {2, 12, 14, 10, 6, 7, 5, 2, 2, 0, 1},  {2, 3, 13, 9, 64, 13, 9, 3, 1, 2, 2},
      {1, 64, 5, 6, 140, 5, 6, 1, 1, 0, 1},  {1, 9, 5, 5, 4, 3, 3, 1, 2, 0, 1},
      {1, 8, 7, 7, 4, 7, 7, 3, 1, 18, 18},   {1, 10, 21, 18, 7, 10, 9, 3, 2, 2, 2}};
  return all;
}

/// The weight gradient, onto NaN and onto what that left.
void check_gradient(const Device& device, const ConvShape& s, Storage storage) {
  const TensorSpec x_spec = stored_as(channels4({s.n, s.ci, s.h, s.w}), storage);
  const TensorSpec dy_spec = stored_as(channels4({s.n, s.co, s.ho, s.wo}), storage);
  const TensorSpec w_spec = row_major({s.co, s.ci, s.kernel, s.kernel});
  const auto weights = static_cast<size_t>(w_spec.shape.elements());
  const Values x = draw(x_spec, 1);
  const Values dy = draw(dy_spec, 2);
  GuardedMemory memory(device);
  const Slice x_slice = place(device, memory, x_spec, x);
  const Slice dy_slice = place(device, memory, dy_spec, dy);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Slice dw = place(device, memory, w_spec, Values(weights, nan));
  const uint64_t bytes = weight_gradient_scratch(s, device.caps(), WeightGradientKernel::kCooperative);
  const TensorSpec scratch_spec = row_major({static_cast<int64_t>(bytes / 4)});
  const Slice scratch = place(device, memory, scratch_spec, Values(bytes / 4, nan));
  Sums sums(weights);
  for (const uint32_t accumulate : {0U, 1U}) {
    Recorder recorder(device, false, Bounds::kGuarded);
    record_weight_gradient(recorder, s, x_slice, dy_slice, dw, accumulate, scratch,
                           WeightGradientKernel::kCooperative);
    test::run_guarded(recorder, memory);
    const Values half_x = rounded(x);
    const Values half_dy = rounded(dy);
    test::each_product(s,
                       [&](size_t xi, size_t wi, size_t y) { sums.add(wi, product(half_x[xi], half_dy[y])); });
    sums.expect(from_layout(w_spec, download_values<float>(device, dw)), Storage::kFloat32);
  }
}

void check_shapes(const Device& device, size_t step) {
  for (const Storage storage : {Storage::kFloat16, Storage::kFloat32})
    for (size_t i = 0; i < shapes().size(); i += step) {
      SCOPED_TRACE(fmt::format("shape {}, float{}", i, storage == Storage::kFloat16 ? 16 : 32));
      for (const ConvDirection direction : {ConvDirection::kForward, ConvDirection::kTransposed}) {
        SCOPED_TRACE(direction == ConvDirection::kForward ? "forward" : "transposed");
        Problem problem(device, shapes()[i], direction, storage);
        problem.expect(problem.run("cooperative", 1), true);
        problem.expect(problem.run("cooperative", 0, false), false, false);
      }
      SCOPED_TRACE("weight gradient");
      check_gradient(device, shapes()[i], storage);
    }
}

TEST(ConvCooperativeTest, MatchesPlainLoops) {
  if (!missing().empty()) GTEST_SKIP() << missing();
  check_shapes(test_device(), 1);
}

TEST(ConvCooperativeTest, MatchesPlainLoopsOnTheOtherAccessPath) {
  if (!missing().empty()) GTEST_SKIP() << missing();
  if (other_access_device() == nullptr) GTEST_SKIP() << missing_for(AccessPath::kTexel, test_device().caps());
  check_shapes(*other_access_device(), 2);
}

/// Small shapes are given small tiles: here every tile has its turn, by way of the tuner's choices.
TEST(ConvCooperativeTest, EveryTileMatchesPlainLoops) {
  if (!missing().empty()) GTEST_SKIP() << missing();
  auto choices = std::make_shared<TunedChoices>();
  const Device device({.selector = "",
                       .on_message = fail_test,
                       .kernels = KernelFamily::kCooperative,
                       .tuned = [&](const Caps&) { return choices; }});
  const ConvShape shape{2, 20, 9, 11, 40, 9, 11, 3, 1, 1, 1};
  const ConvStorage stored{Storage::kFloat16, Storage::kFloat16};
  size_t count = 0;
  for (const CooperativeTile& tile : cooperative_tiles(CooperativeUse::kProduct, device.caps())) {
    if (2 * tile.slab() <= 32 && tile.rows * tile.columns > 1) continue;  // as others, but less deep
    SCOPED_TRACE(fmt::format("tile {}", fmt::join(numbers_of(tile), " ")));
    for (const ConvDirection direction : {ConvDirection::kForward, ConvDirection::kTransposed}) {
      const auto kernel = direction == ConvDirection::kForward ? kCooperativeForward : kCooperativeTransposed;
      (*choices)[tuning_key(kernel, shape, stored)] = numbers_of(tile);
      Problem problem(device, shape, direction, Storage::kFloat16);
      problem.expect(problem.run({}, 1), true);
    }
    (*choices)[tuning_key(kCooperativeGradient, shape, stored)] = numbers_of(tile);
    if (fits(tile, CooperativeUse::kWeightGradient, device.caps()))
      check_gradient(device, shape, Storage::kFloat16);
    ++count;
  }
  EXPECT_GT(count, 8U);
}

/// What is float32 is never rounded: the family takes the shared kernels for it, to the bit.
TEST(ConvCooperativeTest, TheFamilyLeavesFloat32Alone) {
  const Device* device = family_device(KernelFamily::kCooperative);
  if (device == nullptr) GTEST_SKIP() << missing();
  const ConvShape& shape = shapes()[2];
  for (const Storage storage : {Storage::kFloat32, Storage::kFloat16}) {
    Problem problem(*device, shape, ConvDirection::kForward, storage);
    const Values got = problem.run({}, 1);
    EXPECT_EQ(got == problem.run("shared", 1), storage == Storage::kFloat32);
    EXPECT_EQ(got == problem.run("cooperative", 1), storage == Storage::kFloat16);
  }
}

}  // namespace
}  // namespace vkopple
