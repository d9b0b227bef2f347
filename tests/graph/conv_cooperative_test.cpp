#include "graph/conv/conv_cooperative.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>
#include <vector>

#include "graph/conv/conv_product.h"
#include "graph/float16.h"
#include "graph/tensor.h"
#include "runtime/device.h"
#include "runtime/transfer.h"
#include "tests/support/conv_reference.h"
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

/// A product, its operands and what it should make.
class Problem {
 public:
  Problem(const Device& device, const ConvShape& s, ConvDirection direction, Storage storage)
      : device_(device),
        shape_(s),
        direction_(direction),
        arena_(device, MemoryKind::kDevice, "conv_cooperative_test"),
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
    const ConvOperands operands{.in = place(in_spec_, in_),
                                .w = place(w_spec_, w_),
                                .bias = has_bias ? place(bias_spec_, bias_) : Slice{},
                                .out = place(out_spec_, before_),
                                .accumulate = accumulate};
    Recorder recorder(device_);
    record_conv_product(recorder, shape_, direction_, operands,
                        arena_.allocate(conv_product_scratch(shape_, direction_)), kernel);
    recorder.finish()->run();
    const Values words = download_values<float>(device_, operands.out);
    require_zero_padding(words);
    return from_layout(out_spec_, words);
  }

  /// Expects every element within the error that the device may make: operands rounded to float16 are taken as
  /// given, their products are exact in float32 (22 digits), and each of the sum's terms may then round, or be
  /// cut off as matrix units do, by 2^-23 of what has been summed; and the result by its storage.
  void expect(const Values& got, bool accumulates, bool has_bias = true) const {
    const size_t count = got.size();
    std::vector<double> want(count, 0.0), size(count, 0.0), terms(count, 2.0);
    const Values in = rounded(in_);
    const Values w = rounded(w_);
    const auto plane = static_cast<size_t>(out_spec_.shape[2] * out_spec_.shape[3]);
    const auto add = [&](size_t at, double term) {
      want[at] += term;
      size[at] += std::abs(term);
      terms[at] += 1;
    };
    for (size_t i = 0; i < count; ++i) {
      if (accumulates) add(i, static_cast<double>(before_[i]));
      if (has_bias) add(i, static_cast<double>(bias_[i / plane % bias_.size()]));
    }
    test::each_product(shape_, [&](size_t x, size_t wi, size_t y) {
      const bool forward = direction_ == ConvDirection::kForward;
      add(forward ? y : x, static_cast<double>(in[forward ? x : y]) * static_cast<double>(w[wi]));
    });
    const double stored = out_spec_.storage == Storage::kFloat16 ? kFloat16Roundoff : 0.0;
    for (size_t i = 0; i < count; ++i) {
      const double summed = terms[i] * std::ldexp(1.0, -23) * size[i];
      const double limit = summed + stored * (std::abs(want[i]) + summed) + std::ldexp(1.0, -25);
      ASSERT_LE(std::abs(static_cast<double>(got[i]) - want[i]), limit)
          << "element " << i << " is " << got[i] << " and should be " << want[i];
    }
  }

 private:
  Slice place(const TensorSpec& spec, const Values& values) {
    Slice slice = arena_.allocate(spec.bytes());
    slice.storage = spec.storage;
    upload_values<float>(device_, slice, to_layout(spec, values));
    return slice;
  }

  void require_zero_padding(const Values& words) const {
    const TensorSpec plain = stored_as(out_spec_, Storage::kFloat32);
    const Values stored = out_spec_.storage == Storage::kFloat16 ? from_float16(words) : words;
    EXPECT_EQ(to_layout(plain, from_layout(plain, stored)), stored) << "padding lanes";
  }

  const Device& device_;
  ConvShape shape_;
  ConvDirection direction_;
  Arena arena_;
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

void check_shapes(const Device& device, size_t step) {
  for (const Storage storage : {Storage::kFloat16, Storage::kFloat32})
    for (const ConvDirection direction : {ConvDirection::kForward, ConvDirection::kTransposed})
      for (size_t i = 0; i < shapes().size(); i += step) {
        SCOPED_TRACE(fmt::format("shape {}, {}, float{}", i,
                                 direction == ConvDirection::kForward ? "forward" : "transposed",
                                 storage == Storage::kFloat16 ? 16 : 32));
        Problem problem(device, shapes()[i], direction, storage);
        problem.expect(problem.run("cooperative", 1), true);
        problem.expect(problem.run("cooperative", 0, false), false, false);
      }
}

TEST(ConvCooperativeTest, MatchesPlainLoops) {
  if (!missing().empty()) GTEST_SKIP() << missing();
  check_shapes(test_device(), 1);
}

TEST(ConvCooperativeTest, MatchesPlainLoopsOnTheOtherAccessPath) {
  if (!missing().empty()) GTEST_SKIP() << missing();
  if (other_access_device() == nullptr)
    GTEST_SKIP() << "the device has one access path only: it lacks 64-bit integers";
  check_shapes(*other_access_device(), 2);
}

}  // namespace
}  // namespace vkopple
