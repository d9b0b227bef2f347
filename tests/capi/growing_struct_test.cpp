#include "capi/growing_struct.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "tests/support/expect_error.h"

namespace vkopple::capi {
namespace {

/// What a caller of the first version has, and what lies behind it in its memory.
struct First {
  size_t struct_size;
  int32_t a;
  int32_t behind;
};
struct Second {
  size_t struct_size;
  int32_t a;
  int32_t b;
};
constexpr size_t kFirst = offsetof(First, a) + sizeof(int32_t);

Second read(size_t size) {
  First given{size, 5, 6};
  Second memory{};
  std::memcpy(&memory, &given, sizeof memory);
  return read_struct(&memory, Second{sizeof(Second), 1, 2}, kFirst, "thing");
}

TEST(GrowingStruct, ReadsWhatACallerKnows) {
  const Second old = read(kFirst);
  EXPECT_EQ(old.struct_size, sizeof(Second));
  EXPECT_EQ(old.a, 5);
  EXPECT_EQ(old.b, 2);
  EXPECT_EQ(read(sizeof(Second)).b, 6);
}

TEST(GrowingStruct, WritesWhatACallerKnows) {
  for (const size_t size : {kFirst, sizeof(Second)}) {
    Second memory{size, 5, 6};
    write_struct(&memory, Second{sizeof(Second), 1, 2}, kFirst, "thing");
    EXPECT_EQ(memory.struct_size, size);
    EXPECT_EQ(memory.a, 1);
    EXPECT_EQ(memory.b, size == kFirst ? 6 : 2);
  }
}

TEST(GrowingStruct, RefusesSizesOfNoVersion) {
  test::expect_error([] { read(kFirst - 1); }, {"thing.struct_size is 11", "12 at least", "sizeof(thing)"});
  test::expect_error([] { read(sizeof(Second) + 1); }, {"17", "16 at most in vkopple 0.1.0", "newer library"});
  Second memory{3, 5, 6};
  test::expect_error([&] { write_struct(&memory, Second{}, kFirst, "thing"); }, {"3"});
  EXPECT_EQ(memory.a, 5);
}

}  // namespace
}  // namespace vkopple::capi
