#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "graph/checks/check.h"
#include "runtime/device.h"
#include "runtime/guarded_memory.h"
#include "runtime/guarded_shader.h"
#include "runtime/transfer.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Where the kernel of StrayOp goes astray, in elements; 0: nowhere.
struct Stray {
  int forward = 0;   ///< it writes this one of the output too
  int backward = 0;  ///< … of the gradient
  int ahead = 0;     ///< it reads so much further than it should
};

/// y = x, by a kernel that does more than that (shaders/checks/stray.comp).
class StrayOp : public Op {
 public:
  explicit StrayOp(const Stray& stray) : stray_(stray) {}
  std::string_view name() const override { return "stray"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override { return {x[0]}; }
  Needs needs(std::span<const TensorSpec>, const Caps&) const override {
    return {.inputs_for_backward = 0, .outputs_for_backward = 0};
  }
  void record_forward(Recorder& recorder, const Forward& io) const override {
    copy(recorder, io.x[0], io.y[0], stray_.forward, 0);
  }
  void record_backward(Recorder& recorder, const Backward& io) const override {
    copy(recorder, io.dy[0], io.dx[0], stray_.backward, io.accumulates(0));
  }

 private:
  struct Push {
    uint32_t count;
    int32_t stray;
    int32_t ahead;
    float zero;
    uint32_t accumulate;
  };
  void copy(Recorder& recorder, const Operand& from, const Operand& to, int stray, uint32_t accumulate) const {
    const bool wide = from.spec.layout == Layout::kChannels4;
    const auto count = static_cast<uint32_t>(from.spec.elements() / (wide ? 4 : 1));
    recorder.dispatch_flat(wide ? "stray.vec4s" : "stray.words", count, {from.slice, to.slice},
                           Push{count, stray, stray_.ahead, 0.0F, accumulate});
  }

  Stray stray_;
};

/// 24 words, or 6 vectors of 4.
CheckCase stray_case(const Stray& stray, Layout layout) {
  const TensorSpec spec{.shape = {1, 8, 1, 3}, .layout = layout};
  return {.label = "24 numbers",
          .op = std::make_shared<StrayOp>(stray),
          .inputs = {spec},
          .reference = [](const HostTensors& x) { return x; }};
}

std::vector<std::string> failures(const Device& device, const Stray& stray, Layout layout,
                                  Storage storage = Storage::kFloat32) {
  return run_check(device, stray_case(stray, layout), storage).failures;
}

class Guards : public testing::TestWithParam<AccessPath> {
 protected:
  void SetUp() override {
    if (test_device().caps().access == GetParam())
      device_ = &test_device();
    else
      device_ = other_access_device();
    if (device_ == nullptr) GTEST_SKIP() << missing_for(GetParam(), test_device().caps());
  }
  const Device* device_ = nullptr;
};

INSTANTIATE_TEST_SUITE_P(AccessPaths, Guards, testing::Values(AccessPath::kTexel, AccessPath::kStorage));

TEST_P(Guards, LetPassWhatStaysInside) {
  for (const Layout layout : {Layout::kRowMajor, Layout::kChannels4})
    EXPECT_THAT(failures(*device_, {}, layout), IsEmpty());
}

TEST_P(Guards, AnElementBeyondTheEndIsReported) {
  EXPECT_THAT(failures(*device_, {.forward = 24}, Layout::kRowMajor),
              Contains(HasSubstr("[stray] wrote outside of its operands in forward: 4 bytes changed beside "
                                 "output 0, the first of them 0 bytes beyond its end")));
  EXPECT_THAT(
      failures(*device_, {.forward = 6}, Layout::kChannels4),
      Contains(HasSubstr("16 bytes changed beside output 0, the first of them 0 bytes beyond its end")));
}

TEST_P(Guards, AnElementBeforeTheBeginningIsReported) {
  EXPECT_THAT(
      failures(*device_, {.forward = -1}, Layout::kRowMajor),
      Contains(HasSubstr("4 bytes changed beside output 0, the last of them 4 bytes before its beginning")));
  EXPECT_THAT(
      failures(*device_, {.forward = -3}, Layout::kChannels4),
      Contains(HasSubstr("16 bytes changed beside output 0, the last of them 36 bytes before its beginning")));
}

TEST_P(Guards, OfFloat16Too) {
  EXPECT_THAT(failures(*device_, {.forward = 6}, Layout::kChannels4, Storage::kFloat16),
              Contains(HasSubstr("8 bytes changed beside output 0, the first of them 0 bytes beyond its end")));
  EXPECT_THAT(
      failures(*device_, {.forward = -1}, Layout::kChannels4, Storage::kFloat16),
      Contains(HasSubstr("8 bytes changed beside output 0, the last of them 4 bytes before its beginning")));
}

TEST_P(Guards, OfGradientsToo) {
  // Once when gradients are overwritten, once when they are added to.
  EXPECT_THAT(failures(*device_, {.backward = 24}, Layout::kRowMajor),
              Contains(HasSubstr("[stray] wrote outside of its operands in backward: 4 bytes changed beside "
                                 "gradient 0, the first of them 0 bytes beyond its end")));
}

TEST(GuardsTest, WhatIsReadOutsideIsNaNInStorageBuffers) {
  const Device* device =
      test_device().caps().access == AccessPath::kStorage ? &test_device() : other_access_device();
  ASSERT_NE(device, nullptr);
  for (const int ahead : {1, -1}) {
    const auto found = failures(*device, {.ahead = ahead}, Layout::kRowMajor);
    EXPECT_THAT(found, Contains(AllOf(HasSubstr("output 0"), HasSubstr("is nan")))) << ahead;
    EXPECT_THAT(found, Contains(AllOf(HasSubstr("gradient 0"), HasSubstr("is nan")))) << ahead;
  }
}

TEST(GuardsTest, EveryShaderCanBeGuarded) {
  for (const ShaderCode& shader : shader_library()) {
    std::vector<uint32_t> code;
    ASSERT_NO_THROW(code = guarded_code(shader)) << shader.name;
    EXPECT_GT(code.size(), shader.code.size()) << shader.name;
  }
}

TEST(GuardsTest, MemoryWithoutBandsIsRefused) {
  Buffer buffer(test_device(), 4096, MemoryKind::kDevice, "no bands");
  GuardedMemory memory(test_device());
  const Slice x = memory.allocate(64, "x");
  Recorder recorder(test_device(), false, Bounds::kGuarded);
  const struct {
    uint32_t words;
    float slope;
    uint32_t accumulate;
  } push{16, 2.0F, 0};
  test::expect_error(
      [&] {
        recorder.dispatch_flat("leaky_relu.forward", 4, {x, buffer.whole()}, push);
      },
      {"a guarded recording was given memory without bands before and after it"});
}

TEST(GuardedMemoryTest, TellsWhatChangedOnce) {
  GuardedMemory memory(test_device());
  const Slice a = memory.allocate(64, "a");
  const Slice b = memory.allocate(12, "b");
  EXPECT_THAT(memory.damage(), IsEmpty());
  EXPECT_EQ(download_values<uint32_t>(test_device(), b), std::vector<uint32_t>(3, kNaNWord));
  upload_values<uint32_t>(test_device(), {a.buffer, a.offset + 72, 4}, std::vector<uint32_t>{1});
  upload_values<uint32_t>(test_device(), {b.buffer, b.offset - kGuardBytes, 8}, std::vector<uint32_t>{1, 2});
  EXPECT_THAT(memory.damage(),
              ElementsAre("4 bytes changed beside a, the first of them 8 bytes beyond its end",
                          "8 bytes changed beside b, the last of them 2044 bytes before its beginning"));
  EXPECT_THAT(memory.damage(), IsEmpty());
}

}  // namespace
}  // namespace vkopple
