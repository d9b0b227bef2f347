#include "graph/float16.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "graph/executor.h"
#include "graph/ops/affine.h"
#include "graph/ops/relayout.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using test::expect_error;

float power(int exponent) { return std::ldexp(1.0F, exponent); }

TEST(Float16Test, RoundsToNearestEven) {
  EXPECT_EQ(float16_bits(0.0F), 0x0000);
  EXPECT_EQ(float16_bits(-0.0F), 0x8000);
  EXPECT_EQ(float16_bits(1.0F), 0x3c00);
  EXPECT_EQ(float16_bits(-2.0F), 0xc000);
  EXPECT_EQ(float16_bits(1 + power(-11)), 0x3c00);      // half way: to the even one
  EXPECT_EQ(float16_bits(1 + 3 * power(-11)), 0x3c02);  // half way: to the even one
  EXPECT_EQ(float16_bits(1 + power(-11) + power(-20)), 0x3c01);
  EXPECT_EQ(float16_bits(65504.0F), 0x7bff);
  EXPECT_EQ(float16_bits(65519.0F), 0x7bff);
  EXPECT_EQ(float16_bits(65520.0F), 0x7c00);
  EXPECT_EQ(float16_bits(1e30F), 0x7c00);
  EXPECT_EQ(float16_bits(-std::numeric_limits<float>::infinity()), 0xfc00);
  EXPECT_EQ(float16_bits(std::numeric_limits<float>::quiet_NaN()) & 0x7fff, 0x7e00);
  EXPECT_EQ(float16_bits(power(-14)), 0x0400);
  EXPECT_EQ(float16_bits(power(-24)), 0x0001);
  EXPECT_EQ(float16_bits(power(-25)), 0x0000);  // half way: to the even one
  EXPECT_EQ(float16_bits(3 * power(-25)), 0x0002);
  EXPECT_EQ(float16_bits(power(-25) + power(-30)), 0x0001);
  EXPECT_EQ(float16_bits(1e-40F), 0x0000);
}

TEST(Float16Test, EveryNumberComesBack) {
  for (uint32_t bits = 0; bits < 65536; ++bits) {
    const float value = float16_value(static_cast<uint16_t>(bits));
    if (!std::isnan(value)) {
      ASSERT_EQ(float16_bits(value), bits);
    }
  }
}

/// Every float16, what lies half way to the next one, and the float32 on both sides of that.
std::vector<float> interesting_values() {
  std::vector<float> values;
  for (uint32_t bits = 0; bits < 65536; ++bits) {
    const float value = float16_value(static_cast<uint16_t>(bits));
    const bool last = (bits & 0x7fffU) == 0x7bffU;
    const float next = last ? std::copysign(65536.0F, value) : float16_value(static_cast<uint16_t>(bits + 1));
    const float middle = (value + next) / 2;
    values.insert(values.end(), {value, middle, std::nextafter(middle, value), std::nextafter(middle, next)});
  }
  return values;
}

class OnBothPaths : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    device_ = GetParam() ? other_access_device() : &test_device();
    if (device_ == nullptr) GTEST_SKIP() << missing_for(AccessPath::kTexel, test_device().caps());
  }
  const Device* device_ = nullptr;
};

TEST_P(OnBothPaths, DevicesRoundAsTheHostDoes) {
  const auto values = interesting_values();
  Graph graph;
  graph.store_activations(Storage::kFloat16);
  const Value x = graph.input("x", row_major({1, 4, 256, 256}));
  const Value stored = to_channels4(x);
  const Value back = to_row_major(stored);
  graph.keep("stored", stored);
  graph.keep("back", back);
  ASSERT_EQ(stored.spec().storage, Storage::kFloat16);
  ASSERT_EQ(back.spec().storage, Storage::kFloat32);
  Executor executor(*device_, graph);
  executor.write(x, values);
  executor.forward();
  const auto got = executor.read(stored);
  const auto read = executor.read(back);
  for (size_t i = 0; i < values.size(); ++i) {
    const float want = float16_value(float16_bits(values[i]));
    if (std::isnan(want)) {
      ASSERT_TRUE(std::isnan(got[i]) && std::isnan(read[i])) << values[i];
      continue;
    }
    ASSERT_EQ(std::bit_cast<uint32_t>(got[i]), std::bit_cast<uint32_t>(want)) << values[i];
    // Devices may read subnormal numbers as zeros.
    if (std::abs(want) >= power(-14) || read[i] != 0) {
      ASSERT_EQ(read[i], want) << values[i];
    }
  }
}

TEST_P(OnBothPaths, WordByWordIsRefused) {
  Arena arena(*device_, MemoryKind::kDevice, "test");
  const std::array<Slice, 2> operands{arena.allocate(256), arena.allocate(256)};
  struct {
    uint32_t units = 4;
    float scale = 2;
    uint32_t accumulate = 0;
  } push;
  for (size_t which : {0U, 1U}) {
    auto slices = operands;
    slices[which].storage = Storage::kFloat16;
    Recorder recorder(*device_);
    expect_error(
        [&] {
          recorder.dispatch_flat("add_scaled.words", 1, {slices[0], slices[1]}, push);
        },
        {"add_scaled.words", "operand " + std::to_string(which), "float16"});
    expect_error([&] { recorder.copy(slices[0], slices[1]); }, {"copy", "float16"});
    recorder.dispatch_flat("add_scaled.vec4s", 1, {slices[0], slices[1]}, push);
  }
}

INSTANTIATE_TEST_SUITE_P(Paths, OnBothPaths, testing::Values(false, true));

TEST(Float16Test, RowsAreNeverFloat16) {
  TensorSpec spec = row_major({2, 3});
  EXPECT_EQ(stored_as(spec, Storage::kFloat16), spec);
  spec.storage = Storage::kFloat16;
  expect_error([&] { (void)spec.bytes(); }, {"(2, 3)", "float16"});
}

TEST(Float16Test, ActivationsTakeHalfTheBytes) {
  const auto shared_bytes = [](Storage storage) {
    Graph graph;
    graph.store_activations(storage);
    Value x = to_channels4(graph.input("x", row_major({2, 8, 32, 32})));
    for (int i = 0; i < 4; ++i) x = affine(x, 0.5F, 1);
    graph.keep("y", to_row_major(x));
    return Executor(test_device(), graph).shared_bytes();
  };
  EXPECT_EQ(shared_bytes(Storage::kFloat16) * 2, shared_bytes(Storage::kFloat32));
}

}  // namespace
}  // namespace vkopple
