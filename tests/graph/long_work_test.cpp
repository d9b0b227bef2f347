#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "graph/ops/batch_norm.h"
#include "graph/ops/binary.h"
#include "graph/ops/conv2d.h"
#include "graph/ops/conv_transpose2d.h"
#include "graph/ops/leaky_relu.h"
#include "graph/ops/slice.h"
#include "graph/tensor.h"
#include "runtime/transfer.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using Values = std::vector<float>;

constexpr float kLeast = 0.25F;  ///< of what inputs hold; above 0, as variances are

Values draw(uint64_t count, uint32_t seed) {
  std::mt19937 random(seed);
  Values values(count);
  for (float& v : values) v = kLeast + static_cast<float>(random() % 1000) / 1000.0F;
  return values;
}

/// What an op makes on a device: its outputs, and the gradients of its first inputs. Bit for bit what another
/// device makes that sums in the same order.
class Run {
 public:
  Run(const Device& device, const Op& op, const std::vector<TensorSpec>& inputs)
      : device_(device), arena_(device, MemoryKind::kDevice, "long work test") {
    const Needs needs = op.needs(inputs, device.caps());
    const std::vector<Operand> x = place(inputs);
    const std::vector<Operand> y = place(op.infer(inputs));
    const std::vector<Operand> dy = place(op.infer(inputs));
    const std::vector<Operand> saved = place(needs.saved);
    std::vector<Operand> dx = place(inputs);
    for (size_t i = 0; i < dx.size(); ++i)
      if (!op.differentiable(i)) dx[i].slice = {};
    const std::vector<uint8_t> accumulate(dx.size(), 0);
    const Slice scratch =
        arena_.allocate(std::max({uint64_t{256}, needs.forward_scratch, needs.backward_scratch}));
    Recorder recorder(device);
    op.record_forward(recorder, {x, y, saved, scratch});
    op.record_backward(recorder, {x, y, saved, dy, dx, accumulate, scratch});
    recorder.finish()->run();
    for (const Operand& made : y) results.push_back(download_values<float>(device, made.slice));
    for (const Operand& made : dx)
      if (made) results.push_back(download_values<float>(device, made.slice));
  }

  std::vector<Values> results;

 private:
  std::vector<Operand> place(const std::vector<TensorSpec>& specs) {
    std::vector<Operand> operands;
    for (const TensorSpec& spec : specs) {
      operands.push_back({spec, arena_.allocate(spec.bytes())});
      upload_values<float>(device_, operands.back().slice, draw(spec.bytes() / 4, seed_++));
    }
    return operands;
  }

  const Device& device_;
  Arena arena_;
  uint32_t seed_ = 1;
};

void expect_same(const Op& op, const std::vector<TensorSpec>& inputs) {
  if (!long_work_device().caps().row_stores)
    GTEST_SKIP() << "the device stores no rows: all kernels are the same";
  const std::vector<Values> got = Run(long_work_device(), op, inputs).results;
  const std::vector<Values> want = Run(test_device(), op, inputs).results;
  ASSERT_EQ(got.size(), want.size());
  for (size_t t = 0; t < want.size(); ++t) {
    ASSERT_EQ(got[t].size(), want[t].size());
    size_t different = 0;
    for (size_t i = 0; i < want[t].size(); ++i) different += got[t][i] == want[t][i] ? 0 : 1;
    EXPECT_EQ(different, 0U) << op.name() << ", result " << t;
  }
}

// Enough for many rows a workgroup, and not whole workgroups.
const TensorSpec kLarge = channels4({2, 35, 130, 61});

TEST(LongWorkTest, SumsOfTensors) { expect_same(Binary(BinaryKind::kAdd), {kLarge, kLarge}); }

TEST(LongWorkTest, LeakyRelu) { expect_same(LeakyRelu(0.2F), {kLarge}); }

TEST(LongWorkTest, CopiesOfRuns) { expect_same(SliceOp(1, 1, 2), {row_major({2, 4, 131072})}); }

TEST(LongWorkTest, BatchNorm) {
  // A plane's last workgroup has rows to spare.
  for (const int64_t width : {61, 64})
    expect_same(BatchNorm({.groups = 2, .slope = 0.2F}),
                {channels4({2, 6, 18, width}), row_major({6}), row_major({6}), row_major({6}), row_major({6})});
}

TEST(LongWorkTest, ConvolutionsOfLongSums) {
  // Of stride 1 with Winograd's algorithm on neither device, since the kernel is forced.
  expect_same(Conv2d({.padding = 1, .kernel = "window"}, true),
              {channels4({2, 68, 9, 21}), row_major({36, 68, 3, 3}), row_major({36})});
  expect_same(Conv2d({.padding = 1, .kernel = "shuffle"}, true),
              {channels4({3, 68, 8, 8}), row_major({36, 68, 3, 3}), row_major({36})});
}

TEST(LongWorkTest, TransposedConvolutions) {
  expect_same(ConvTranspose2d({}, true),
              {channels4({2, 36, 16, 16}), row_major({36, 64, 3, 3}), row_major({64})});
}

}  // namespace
}  // namespace vkopple
