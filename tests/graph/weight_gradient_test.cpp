#include "graph/conv/weight_gradient.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "runtime/device.h"
#include "runtime/transfer.h"
#include "tests/support/expect_error.h"
#include "tests/support/guarded.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::vector<float> draw(int64_t count, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> values(static_cast<size_t>(count));
  for (float& v : values) v = static_cast<float>(random()) / 2147483648.0F - 0.9F;
  return values;
}

/// The sum of the header, loop by loop.
std::vector<double> reference(const ConvShape& s, const std::vector<float>& x, const std::vector<float>& dy) {
  std::vector<double> dw;
  const auto at = [](const std::vector<float>& t, int64_t i) {
    return static_cast<double>(t[static_cast<size_t>(i)]);
  };
  for (int64_t co = 0; co < s.co; ++co)
    for (int64_t ci = 0; ci < s.ci; ++ci)
      for (int64_t ky = 0; ky < s.kernel; ++ky)
        for (int64_t kx = 0; kx < s.kernel; ++kx) {
          double sum = 0;
          for (int64_t n = 0; n < s.n; ++n)
            for (int64_t yo = 0; yo < s.ho; ++yo)
              for (int64_t xo = 0; xo < s.wo; ++xo) {
                const int64_t y = yo * s.stride + ky * s.dilation - s.padding;
                const int64_t xx = xo * s.stride + kx * s.dilation - s.padding;
                if (y < 0 || y >= s.h || xx < 0 || xx >= s.w) continue;
                sum += at(dy, ((n * s.co + co) * s.ho + yo) * s.wo + xo) *
                       at(x, ((n * s.ci + ci) * s.h + y) * s.w + xx);
              }
          dw.push_back(sum);
        }
  return dw;
}

/// Expects `got` within `limit` of `want`, measured against the root mean square of `want`.
void expect_close(const std::vector<float>& got, const std::vector<double>& want, double limit) {
  ASSERT_EQ(got.size(), want.size());
  double square = 0;
  for (double v : want) square += v * v;
  const double scale = std::sqrt(square / static_cast<double>(want.size())) + 1e-30;
  for (size_t i = 0; i < want.size(); ++i)
    ASSERT_TRUE(std::abs(static_cast<double>(got[i]) - want[i]) <= limit * scale)
        << "element " << i << " is " << got[i] << " and should be " << want[i];
}

Slice place(const Device& device, GuardedMemory& memory, const std::vector<float>& values) {
  const Slice slice = memory.allocate(values.size() * 4, "an operand");
  upload_values<float>(device, slice, values);
  return slice;
}

std::vector<float> download(const Device& device, const Slice& slice, size_t count) {
  auto values = download_values<float>(device, slice);
  values.resize(count);
  return values;
}

/// Runs one shape: onto NaN, then onto what the first run left.
void check(const Device& device, const ConvShape& s, WeightGradientKernel kernel, double limit) {
  if (!can_weight_gradient(s, device.caps(), kernel)) return;
  SCOPED_TRACE(fmt::format(
      "kernel family {}, x ({}, {}, {}, {}), dy ({}, {}, {}), kernel {}, stride {}, padding {}, dilation {}",
      static_cast<int>(kernel), s.n, s.ci, s.h, s.w, s.co, s.ho, s.wo, s.kernel, s.stride, s.padding,
      s.dilation));
  const TensorSpec x_spec = channels4({s.n, s.ci, s.h, s.w});
  const TensorSpec dy_spec = channels4({s.n, s.co, s.ho, s.wo});
  const auto x = draw(x_spec.shape.elements(), 1);
  const auto dy = draw(dy_spec.shape.elements(), 2);
  GuardedMemory memory(device);
  const Slice x_slice = place(device, memory, to_layout(x_spec, x));
  const Slice dy_slice = place(device, memory, to_layout(dy_spec, dy));
  auto want = reference(s, x, dy);
  const Slice dw = place(device, memory, std::vector<float>(want.size(), kNaN));
  const uint64_t bytes = weight_gradient_scratch(s, device.caps(), kernel);
  const Slice scratch = place(device, memory, std::vector<float>(bytes / 4, kNaN));
  for (uint32_t accumulate : {0U, 1U}) {
    Recorder recorder(device, false, Bounds::kGuarded);
    record_weight_gradient(recorder, s, x_slice, dy_slice, dw, accumulate, scratch, kernel);
    test::run_guarded(recorder, memory);
    if (accumulate == 1)
      for (double& v : want) v *= 2;
    expect_close(download(device, dw, want.size()), want, limit);
  }
}

constexpr WeightGradientKernel kKernels[] = {WeightGradientKernel::kSimple, WeightGradientKernel::kRegister,
                                             WeightGradientKernel::kShared};

/// n, ci, h, w, co, ho, wo, kernel, stride, padding, dilation
const std::vector<ConvShape>& shapes() {
  static const std::vector<ConvShape> all{
      {1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1},      {1, 1, 1, 1, 1, 1, 1, 3, 1, 1, 1},
      {3, 5, 1, 1, 7, 1, 1, 3, 1, 1, 1},      {2, 4, 8, 8, 8, 8, 8, 3, 1, 1, 1},
      {2, 3, 9, 17, 64, 9, 17, 3, 1, 1, 1},   {1, 16, 16, 16, 16, 16, 16, 3, 1, 1, 1},
      {2, 8, 7, 19, 12, 7, 19, 3, 1, 1, 1},   {1, 8, 33, 23, 8, 33, 23, 3, 1, 1, 1},
      {1, 11, 13, 5, 9, 13, 5, 3, 1, 1, 1},   {1, 36, 6, 10, 20, 6, 10, 3, 1, 1, 1},
      {2, 7, 9, 9, 10, 7, 7, 3, 1, 0, 1},     {2, 7, 9, 11, 10, 13, 15, 3, 1, 3, 1},
      {1, 12, 11, 11, 6, 11, 11, 3, 1, 2, 2}, {1, 5, 9, 20, 6, 9, 20, 3, 1, 6, 6},
      {1, 8, 7, 7, 4, 7, 7, 3, 1, 18, 18},    {1, 9, 9, 9, 5, 5, 5, 3, 2, 1, 1},
      {2, 16, 16, 16, 24, 8, 8, 3, 2, 1, 1},  {2, 8, 15, 22, 16, 8, 11, 3, 2, 1, 1},
      {1, 4, 2, 2, 4, 1, 1, 3, 2, 1, 1},      {1, 10, 21, 18, 7, 10, 9, 3, 2, 2, 2},
      {1, 8, 1, 1, 8, 1, 1, 3, 2, 1, 1},      {2, 6, 12, 14, 9, 6, 7, 2, 2, 0, 1},
      {2, 16, 32, 32, 8, 16, 16, 2, 2, 0, 1}, {1, 5, 3, 9, 4, 2, 4, 2, 2, 0, 1},
      {1, 5, 8, 8, 3, 7, 7, 2, 1, 0, 1},      {2, 13, 5, 9, 11, 5, 9, 1, 1, 0, 1},
      {1, 64, 6, 6, 40, 6, 6, 1, 1, 0, 1},    {1, 6, 9, 9, 5, 5, 5, 1, 2, 0, 1},
      {4, 160, 1, 1, 130, 1, 1, 1, 1, 0, 1},  {2, 3, 4, 4, 5, 6, 6, 1, 1, 1, 1}};
  return all;
}

/// Every `step`-th shape with every kernel: each has pipelines of its own, which take a while to build.
void check_shapes(const Device& device, size_t step) {
  for (WeightGradientKernel kernel : kKernels)
    for (size_t i = 0; i < shapes().size(); i += step) check(device, shapes()[i], kernel, 2e-6);
}

TEST(WeightGradientTest, MatchesItsSum) { check_shapes(test_device(), 1); }

TEST(WeightGradientTest, MatchesItsSumOnTheOtherAccessPath) {
  if (other_access_device() == nullptr) GTEST_SKIP() << missing_for(AccessPath::kTexel, test_device().caps());
  check_shapes(*other_access_device(), 4);
}

TEST(WeightGradientTest, RefusesAKernelThatTheDeviceCannotRun) {
  Caps caps;
  caps.type = DeviceType::kDiscrete;
  const ConvShape shape{1, 4, 4, 4, 4, 4, 4, 3, 1, 1, 1};
  EXPECT_FALSE(can_weight_gradient(shape, caps, WeightGradientKernel::kRegister));
  EXPECT_GT(weight_gradient_scratch(shape, caps), 0U);
  test::expect_error([&] { weight_gradient_scratch(shape, caps, WeightGradientKernel::kRegister); },
                     {"weight gradient", "3x3"});
}

TEST(WeightGradientTest, KeepsFloatAccuracyOverManyPixels) {
  for (WeightGradientKernel kernel : kKernels) {
    check(test_device(), {2, 3, 256, 192, 2, 256, 192, 3, 1, 1, 1}, kernel, 3e-6);
    check(test_device(), {2, 4, 256, 256, 4, 128, 128, 2, 2, 0, 1}, kernel, 3e-6);
    check(test_device(), {2, 4, 192, 256, 4, 192, 256, 1, 1, 0, 1}, kernel, 3e-6);
  }
}

void check_bias(const Device& device, const Shape& shape) {
  SCOPED_TRACE(shape.text());
  const TensorSpec spec = channels4(shape);
  const auto dy = draw(shape.elements(), 3);
  std::vector<double> want(static_cast<size_t>(shape[1]), 0.0);
  const auto image = static_cast<size_t>(shape[2] * shape[3]);
  for (size_t i = 0; i < dy.size(); ++i) want[i / image % want.size()] += static_cast<double>(dy[i]);
  GuardedMemory memory(device);
  const Slice dy_slice = place(device, memory, to_layout(spec, dy));
  const Slice db = place(device, memory, std::vector<float>(want.size(), kNaN));
  const uint64_t bytes = bias_gradient_scratch(spec, device.caps());
  const Slice scratch = place(device, memory, std::vector<float>(bytes / 4, kNaN));
  for (uint32_t accumulate : {0U, 1U}) {
    Recorder recorder(device, false, Bounds::kGuarded);
    record_bias_gradient(recorder, spec, dy_slice, db, accumulate, scratch);
    test::run_guarded(recorder, memory);
    if (accumulate == 1)
      for (double& v : want) v *= 2;
    expect_close(download(device, db, want.size()), want, 2e-6);
  }
}

TEST(BiasGradientTest, MatchesItsSum) {
  for (const Device* device : {&test_device(), other_access_device()}) {
    if (device == nullptr) continue;
    check_bias(*device, {1, 1, 1, 1});
    check_bias(*device, {3, 7, 1, 1});
    check_bias(*device, {2, 12, 5, 13});
    check_bias(*device, {1, 3, 64, 65});
    check_bias(*device, {5, 130, 9, 8});
    check_bias(*device, {4, 2, 256, 251});
  }
}

}  // namespace
}  // namespace vkopple
