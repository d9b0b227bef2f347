#include "graph/conv/conv_tuning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "graph/conv/conv_product.h"
#include "graph/conv/weight_gradient.h"
#include "graph/tensor.h"
#include "runtime/transfer.h"
#include "tests/support/gpu_caps.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using test::gpu_caps;

const ConvShape kShape{2, 20, 13, 11, 36, 13, 11, 3, 1, 1, 1};

void choose(Caps& caps, const std::string& key, std::vector<uint32_t> numbers) {
  caps.tuned = std::make_shared<const TunedChoices>(TunedChoices{{key, std::move(numbers)}});
}

TEST(ConvTuning, CandidatesFitAndAreNotTheStandard) {
  const Caps caps = gpu_caps();
  const auto tuning = conv_product_tuning(kShape, ConvDirection::kForward, caps);
  ASSERT_TRUE(tuning);
  EXPECT_EQ(tuning->key,
            "conv_shared.forward 3x3 stride 1 padding 1 dilation 1, 2x20x13x11 float32 to 36x13x11 float32");
  EXPECT_GT(tuning->candidates.size(), 10U);
  for (const auto& tile : tuning->candidates) {
    EXPECT_NE(tile, tuning->standard);
    EXPECT_TRUE(is_tuned_choice(tuning->key, tile, caps));
  }
  const auto gradient = weight_gradient_tuning(kShape, caps);
  ASSERT_TRUE(gradient);
  for (const auto& tile : gradient->candidates) EXPECT_TRUE(is_tuned_choice(gradient->key, tile, caps));
}

TEST(ConvTuning, EveryStorageHasAChoiceOfItsOwn) {
  const ConvStorage mixed{.x = Storage::kFloat16};
  Caps caps = gpu_caps();
  const auto tuning = conv_product_tuning(kShape, ConvDirection::kTransposed, caps, mixed);
  ASSERT_TRUE(tuning);
  EXPECT_EQ(tuning->key,
            "conv_shared.transposed 3x3 stride 1 padding 1 dilation 1, 2x20x13x11 float16 to 36x13x11 float32");
  // Of the product, x is the output.
  const Slice half{.storage = Storage::kFloat16};
  const ConvOperands operands{.in = {}, .w = {}, .bias = {}, .out = half};
  EXPECT_EQ(tuning_key(kSharedTransposed, kShape, operands.storage(ConvDirection::kTransposed)), tuning->key);
  EXPECT_NE(tuning_key(kSharedTransposed, kShape, operands.storage(ConvDirection::kForward)), tuning->key);

  // Scratch holds as many strips of sums as the tile of any storage leaves.
  const auto gradient = weight_gradient_tuning(kShape, caps, mixed);
  ASSERT_TRUE(gradient);
  const uint64_t standard = weight_gradient_scratch(kShape, caps);
  uint64_t most = standard;
  for (const auto& tile : gradient->candidates) {
    choose(caps, gradient->key, tile);
    EXPECT_GE(weight_gradient_scratch(kShape, caps), standard);
    most = std::max(most, weight_gradient_scratch(kShape, caps));
  }
  EXPECT_GT(most, standard);
}

TEST(ConvTuning, PlainKernelsHaveNoTiles) {
  Caps caps = gpu_caps();
  caps.kernels = KernelFamily::kPlain;
  EXPECT_FALSE(conv_product_tuning(kShape, ConvDirection::kForward, caps));
  EXPECT_FALSE(weight_gradient_tuning(kShape, caps));
}

TEST(ConvTuning, IllegalOrForeignChoicesAreNotTaken) {
  Caps caps = gpu_caps();
  const std::string key = tuning_key(kSharedForward, kShape);
  EXPECT_FALSE(tuned_shared_tile(key, caps));
  choose(caps, key, {2, 4, 16, 8, 2});
  EXPECT_EQ(tuned_shared_tile(key, caps), (SharedTile{2, 4, 16, 8, 2}));
  EXPECT_FALSE(tuned_shared_tile(tuning_key(kSharedTransposed, kShape), caps));
  for (const std::vector<uint32_t>& bad : std::vector<std::vector<uint32_t>>{{},
                                                                             {2, 4, 16, 8},
                                                                             {2, 4, 16, 8, 2, 1},
                                                                             {2, 4, 16, 16, 2},
                                                                             {2, 4, 16, 8, 32},
                                                                             {0, 4, 16, 8, 2},
                                                                             {3, 4, 16, 8, 2}}) {
    choose(caps, key, bad);
    EXPECT_FALSE(tuned_shared_tile(key, caps));
    EXPECT_FALSE(is_tuned_choice(key, bad, caps));
  }
  EXPECT_FALSE(is_tuned_choice("conv_of_tomorrow 3x3", {2, 4, 16, 8, 2}, caps));
  EXPECT_FALSE(is_tuned_choice("", {2, 4}, caps));
  // Register tiles: 16 channels are packed for tiles of 16.
  const std::string shuffle = tuning_key(kShuffleForward, kShape);
  choose(caps, shuffle, {8, 4});
  EXPECT_TRUE(tuned_conv_tile(shuffle, 36, caps));
  EXPECT_FALSE(tuned_conv_tile(shuffle, 16, caps));
  choose(caps, shuffle, {1, 4});
  EXPECT_FALSE(tuned_conv_tile(shuffle, 5, caps));
  EXPECT_TRUE(tuned_conv_tile(shuffle, 4, caps));
}

/// A device of one family whose choices the test changes from recording to recording.
class Chosen : public testing::Test {
 protected:
  void open(KernelFamily family) {
    device_ = std::make_unique<Device>(
        DeviceOptions{.selector = "", .kernels = family, .tuned = [this](const Caps&) { return choices_; }});
    arena_ = std::make_unique<Arena>(*device_, MemoryKind::kDevice, "tuning test");
    const ConvShape& s = kShape;
    x_ = place(channels4({s.n, s.ci, s.h, s.w}));
    w_ = place(row_major({s.co, s.ci, s.kernel, s.kernel}));
    dy_ = place(channels4({s.n, s.co, s.ho, s.wo}));
  }

  Slice place(const TensorSpec& spec) {
    std::vector<float> values(static_cast<size_t>(spec.shape.elements()));
    for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i * 7919 % 101) / 50.0F - 1.0F;
    const Slice slice = arena_->allocate(spec.bytes());
    upload_values<float>(*device_, slice, to_layout(spec, values));
    return slice;
  }

  std::vector<float> forward() {
    const Slice y = arena_->allocate(dy_.bytes);
    const Slice scratch = arena_->allocate(conv_product_scratch(kShape, ConvDirection::kForward));
    Recorder recorder(*device_);
    record_conv_product(recorder, kShape, ConvDirection::kForward, {.in = x_, .w = w_, .bias = {}, .out = y},
                        scratch);
    recorder.finish()->run();
    return download_values<float>(*device_, y);
  }

  std::vector<float> weight_gradient() {
    const Slice dw = arena_->allocate(w_.bytes);
    const Slice scratch = arena_->allocate(weight_gradient_scratch(kShape, device_->caps()));
    Recorder recorder(*device_);
    record_weight_gradient(recorder, kShape, x_, dy_, dw, 0, scratch);
    recorder.finish()->run();
    return download_values<float>(*device_, dw);
  }

  /// Every `step`-th candidate makes what the standard does, but for `limit`.
  void expect_same(const ConvTuning& tuning, size_t step, float limit,
                   const std::function<std::vector<float>()>& make) {
    const auto want = make();
    for (size_t i = 0; i < tuning.candidates.size(); i += step) {
      *choices_ = {{tuning.key, tuning.candidates[i]}};
      const auto got = make();
      ASSERT_EQ(got.size(), want.size());
      for (size_t e = 0; e < want.size(); ++e)
        ASSERT_LE(std::abs(got[e] - want[e]), limit) << tuning.key << " candidate " << i << " element " << e;
    }
    choices_->clear();
  }

  std::shared_ptr<TunedChoices> choices_ = std::make_shared<TunedChoices>();
  std::unique_ptr<Device> device_;
  std::unique_ptr<Arena> arena_;
  Slice x_, w_, dy_;
};

size_t step_of_candidates() { return std::getenv("VKOPPLE_ALL_TILES") != nullptr ? 1 : 5; }

TEST_F(Chosen, SharedTilesAllMakeTheSameProduct) {
  open(KernelFamily::kShared);
  // Sums have one order, whatever the tile.
  expect_same(*conv_product_tuning(kShape, ConvDirection::kForward, device_->caps()), step_of_candidates(), 0,
              [&] { return forward(); });
}

TEST_F(Chosen, SharedTilesAllMakeTheSameWeightGradient) {
  open(KernelFamily::kShared);
  expect_same(*weight_gradient_tuning(kShape, device_->caps()), step_of_candidates(), 1e-4F,
              [&] { return weight_gradient(); });
}

TEST_F(Chosen, RegisterTilesAllMakeTheSameProduct) {
  if (family_device(KernelFamily::kRegisters) == nullptr) GTEST_SKIP() << "the device can't run them";
  open(KernelFamily::kRegisters);
  const auto tuning = conv_product_tuning(kShape, ConvDirection::kForward, device_->caps());
  if (!tuning) GTEST_SKIP() << "another kernel takes this shape";
  expect_same(*tuning, step_of_candidates(), 0, [&] { return forward(); });
}

}  // namespace
}  // namespace vkopple
