#include "runtime/dispatch.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/gpu_caps.h"

namespace vkopple {
namespace {

using test::expect_error;

class DispatchTest : public testing::Test {
 protected:
  DispatchTest() {
    caps_.max_storage_range = uint64_t{1} << 27;
    caps_.max_texel_elements = 65536;
  }
  void require(Slice slice, std::vector<uint32_t> constants = {64}, Groups groups = {1, 1, 1}) const {
    // Only its size and storage matter.
    alignas(Buffer) std::byte buffer[sizeof(Buffer)];
    slice.buffer = reinterpret_cast<Buffer*>(buffer);
    const std::vector<Slice> bindings{slice};
    require_limits({"probe", constants, bindings, 0, groups}, {kind_}, caps_);
  }

  Caps caps_ = test::gpu_caps();
  BindingKind kind_ = BindingKind::kRead4;
};

TEST_F(DispatchTest, WhatFitsExactlyPasses) {
  EXPECT_NO_THROW(require({.bytes = uint64_t{1} << 27}, {128}, {65535, 65535, 65535}));
  caps_.access = AccessPath::kTexel;
  EXPECT_NO_THROW(require({.bytes = 65536 * 16}));
  EXPECT_NO_THROW(require({.bytes = 65536 * 8, .storage = Storage::kFloat16}));
}

TEST_F(DispatchTest, InvocationsAreLimited) {
  expect_error([&] { require({.bytes = 16}, {129}); },
               {"shader probe needs workgroups of 129 invocations, made up allows 128"});
  expect_error([&] { require({.bytes = 16}, {}); }, {"workgroups of 0 invocations"});
}

TEST_F(DispatchTest, WorkgroupsAreLimitedInEveryDirection) {
  for (size_t i = 0; i < 3; ++i) {
    Groups groups{1, 1, 1};
    groups[i] = 65536;
    expect_error([&] { require({.bytes = 16}, {64}, groups); },
                 {"needs 65536 workgroups in one direction, made up allows 65535"});
  }
}

TEST_F(DispatchTest, BindingsAreLimited) {
  expect_error([&] { require({.bytes = (uint64_t{1} << 27) + 4}); },
               {"operand 0 has 129 MiB, made up binds at most 128 MiB", "use a smaller --batch"});
  caps_.access = AccessPath::kTexel;
  expect_error([&] { require({.bytes = 65536 * 16 + 16}); }, {"operand 0", "binds at most 1 MiB"});
  expect_error([&] { require({.bytes = 65536 * 8 + 8, .storage = Storage::kFloat16}); }, {"operand 0"});
  kind_ = BindingKind::kWrite4;  // written as a storage buffer
  EXPECT_NO_THROW(require({.bytes = 65536 * 16 + 16}));
}

}  // namespace
}  // namespace vkopple
