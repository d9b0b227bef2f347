#include "graph/matmul/linear_shared.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "graph/matmul/linear_product.h"
#include "runtime/transfer.h"
#include "tests/support/gpu_caps.h"
#include "tests/support/guarded.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using Values = std::vector<float>;

TEST(LinearTile, EveryChoiceFitsTheDevice) {
  test::each_gpu([](const Caps& caps) {
    for (const int64_t rows : {1, 4, 60, 180, 5000})
      for (const int64_t columns : {1, 7, 187, 1024, 40000}) {
        const LinearTile tile = choose_linear_tile(rows, columns, caps);
        EXPECT_TRUE(fits(tile, caps));
        EXPECT_LE(tile.invocations(), caps.max_workgroup_size);
        EXPECT_LE(tile.shared_bytes(), caps.shared_memory_bytes);
      }
  });
}

TEST(LinearTile, GrowsWithTheWork) {
  const Caps caps = test::gpu_caps(1024, 49152);
  const auto area = [&](int64_t rows, int64_t columns) {
    const LinearTile tile = choose_linear_tile(rows, columns, caps);
    return tile.rows() * tile.columns();
  };
  EXPECT_GT(area(5000, 5000), area(60, 187));
  EXPECT_EQ(choose_linear_tile(3, 400000, caps).rows(), 4U);
}

/// A product with operands that begin a few elements into their slices.
struct Product {
  LinearPush push;
  bool bias = true;
};

/// Both longer than a run of terms along one axis, cut by every tile's edges; the second has vectors
/// throughout.
const std::vector<Product> kProducts{
    {{37, 261, 135, 3, 1, 0}, true}, {{260, 36, 132, 4, 8, 0}, false}, {{5, 44, 290, 0, 0, 1}, true}};

class LinearSharedTest : public testing::TestWithParam<LinearPart> {
 protected:
  /// Operands of GetParam()'s product, the output as it was, and the result in double precision.
  void open(const Device& device, const Product& product) {
    device_ = &device;
    product_ = product;
    memory_ = std::make_unique<GuardedMemory>(device);
    const LinearPush& p = product.push;
    x_ = draw(p.x_offset + p.rows * p.inputs, 1);
    w_ = draw(p.outputs * p.inputs, 2);
    dy_ = draw(p.y_offset + p.rows * p.outputs, 3);
    bias_ = draw(p.outputs, 4);
    const auto part = GetParam();
    before_ = part == LinearPart::kForward ? dy_ : part == LinearPart::kDx ? x_ : w_;
    operands_ = {.a = place(part == LinearPart::kForward ? x_ : dy_),
                 .b = place(part == LinearPart::kDw ? x_ : w_),
                 .bias = part == LinearPart::kForward && product.bias ? place(bias_) : Slice{},
                 .out = place(before_)};
  }

  Values run(const LinearTile& tile) {
    upload_values<float>(*device_, operands_.out, before_);
    Recorder recorder(*device_, false, Bounds::kGuarded);
    record_linear_shared(recorder, GetParam(), product_.push, operands_, tile);
    test::run_guarded(recorder, *memory_);
    return download_values<float>(*device_, operands_.out);
  }

  /// What lies in front of the output's offset stays.
  std::vector<double> want() const {
    std::vector<double> out(before_.begin(), before_.end());
    const LinearPush& p = product_.push;
    const bool forward = GetParam() == LinearPart::kForward;
    const size_t offset = forward ? p.y_offset : GetParam() == LinearPart::kDx ? p.x_offset : 0;
    if (forward || p.accumulate == 0)
      std::fill(out.begin() + static_cast<std::ptrdiff_t>(offset), out.end(), 0.0);
    for (size_t m = 0; m < p.rows; ++m)
      for (size_t o = 0; o < p.outputs; ++o) {
        const size_t at_y = p.y_offset + m * p.outputs + o;
        if (forward && product_.bias) out[at_y] += static_cast<double>(bias_[o]);
        for (size_t i = 0; i < p.inputs; ++i) {
          const size_t at_x = p.x_offset + m * p.inputs + i;
          const size_t at_w = o * p.inputs + i;
          if (forward) out[at_y] += multiply(x_[at_x], w_[at_w]);
          if (GetParam() == LinearPart::kDx) out[at_x] += multiply(dy_[at_y], w_[at_w]);
          if (GetParam() == LinearPart::kDw) out[at_w] += multiply(dy_[at_y], x_[at_x]);
        }
      }
    return out;
  }

  const Device* device_ = nullptr;
  Product product_;
  LinearOperands operands_;
  Values x_, w_, dy_, bias_, before_;

 private:
  static double multiply(float a, float b) { return static_cast<double>(a) * static_cast<double>(b); }
  static Values draw(uint32_t count, uint32_t seed) {
    std::mt19937 random(seed);
    Values values(count);
    for (float& v : values) v = static_cast<float>(random() % 2001) / 1000.0F - 1.0F;
    return values;
  }
  Slice place(const Values& values) {
    const Slice slice = memory_->allocate(values.size() * 4, "an operand");
    upload_values<float>(*device_, slice, values);
    return slice;
  }

  std::unique_ptr<GuardedMemory> memory_;
};

/// Each of up to 290 additions rounds a partial sum below 32 by at most 9.6e-7, each product below 1 by 3e-8.
void expect_near(const Values& got, const std::vector<double>& want) {
  constexpr double kLimit = 290 * (9.6e-7 + 3e-8);
  ASSERT_EQ(got.size(), want.size());
  for (size_t i = 0; i < got.size(); ++i) ASSERT_NEAR(static_cast<double>(got[i]), want[i], kLimit) << i;
}

TEST_P(LinearSharedTest, EveryTileMakesTheSameBitsAndIsRight) {
  open(test_device(), kProducts.front());
  const auto exact = want();
  const Values first = run(linear_tiles().back());
  for (const LinearTile& tile : linear_tiles()) {
    if (!fits(tile, device_->caps())) continue;
    const Values got = run(tile);
    EXPECT_EQ(got, first) << tile.rows() << " x " << tile.columns();
    expect_near(got, exact);
  }
}

TEST_P(LinearSharedTest, IsRightHoweverOperandsLieAndAreRead) {
  for (const Device* device : {&test_device(), other_access_device()}) {
    if (device == nullptr) continue;
    for (const Product& product : kProducts) {
      open(*device, product);
      expect_near(run(linear_tiles().back()), want());
    }
  }
}

// Between families nothing may come that LeakyReLU's kink could magnify.
TEST_P(LinearSharedTest, AddsInThePlainKernelsOrder) {
  if (!test_device().caps().cpu()) GTEST_SKIP() << "compilers for GPUs may contract what the plain kernels add";
  const Device& plain = *family_device(KernelFamily::kPlain);
  for (const Product& product : kProducts) {
    open(plain, product);
    const Values shared = run(linear_tiles().front());
    upload_values<float>(plain, operands_.out, before_);
    Recorder recorder(plain);
    const LinearPush& p = product.push;
    const LinearProduct linear(recorder, p.rows, p.inputs, p.outputs, p.x_offset, p.y_offset);
    switch (GetParam()) {
      case LinearPart::kForward:
        linear.forward(operands_.a, operands_.b, operands_.bias, operands_.out);
        break;
      case LinearPart::kDx:
        linear.dx(operands_.a, operands_.b, operands_.out, p.accumulate);
        break;
      case LinearPart::kDw:
        linear.dw(operands_.a, operands_.b, operands_.out, p.accumulate);
        break;
    }
    recorder.finish()->run();
    EXPECT_EQ(shared, download_values<float>(plain, operands_.out));
  }
}

INSTANTIATE_TEST_SUITE_P(Parts, LinearSharedTest,
                         testing::Values(LinearPart::kForward, LinearPart::kDx, LinearPart::kDw));

TEST(LinearProduct, TakesTheKernelOfItsFamily) {
  const Device& device = *family_device(KernelFamily::kShared);
  if (device.caps().timestamp_period == 0)
    GTEST_SKIP() << "the device has no timestamps, which tell kernels' names";
  Arena arena(device, MemoryKind::kDevice, "test");
  const Slice s = arena.allocate(1024);
  const Slice out = arena.allocate(1024);
  Recorder recorder(device, true);
  const LinearProduct product(recorder, 4, 8, 4);
  product.forward(s, s, {}, out);
  product.dx(s, s, out, 0);
  product.dw(s, s, out, 0);
  const auto commands = recorder.finish();
  commands->run();
  const auto times = commands->command_times();
  ASSERT_EQ(times.size(), 3U);
  for (const CommandTime& time : times) EXPECT_EQ(time.name, "linear_shared");
}

}  // namespace
}  // namespace vkopple
