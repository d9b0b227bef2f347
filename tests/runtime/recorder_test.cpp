#include "runtime/recorder.h"

#include <gtest/gtest.h>

#include "runtime/error.h"
#include "runtime/transfer.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

struct ReluPush {
  uint32_t words;
  float slope;
  uint32_t accumulate;
};

class RecorderTest : public testing::Test {
 protected:
  void relu(Recorder& recorder, const Slice& x, const Slice& y) {
    const ReluPush push{64, 2.0F, 0};
    recorder.dispatch_flat("leaky_relu.forward", 16, {x, y}, push);
  }
  Slice allocate() { return arena_.allocate(256); }
  std::vector<float> read(const Slice& s) { return download_values<float>(test_device(), s); }

  Arena arena_{test_device(), MemoryKind::kDevice, "test"};
};

TEST_F(RecorderTest, PlacesABarrierOnlyWhereBytesOverlap) {
  const Slice a = allocate();
  const Slice b = allocate();
  const Slice c = allocate();
  const Slice d = allocate();
  Recorder recorder(test_device());
  relu(recorder, a, b);
  relu(recorder, a, c);  // both read a: no barrier
  relu(recorder, b, d);  // reads what the first wrote
  relu(recorder, c, a);  // c is ordered by now; overwrites what the first two read: ordered too
  EXPECT_EQ(recorder.finish()->barriers(), 1U);
}

TEST_F(RecorderTest, OrdersWriteAfterReadAndWriteAfterWrite) {
  const Slice a = allocate();
  const Slice b = allocate();
  const Slice c = allocate();
  Recorder recorder(test_device());
  relu(recorder, a, b);
  relu(recorder, c, a);  // write after read
  relu(recorder, c, b);  // the first write of b is behind the barrier
  relu(recorder, c, b);  // write after write
  EXPECT_EQ(recorder.finish()->barriers(), 2U);
}

TEST_F(RecorderTest, AbsentOperandsAreOrderedToo) {
  const Slice a = allocate();
  const Slice b = allocate();
  Recorder recorder(test_device());
  relu(recorder, {}, a);
  relu(recorder, {}, b);  // both only read the absent operand
  EXPECT_EQ(recorder.finish()->barriers(), 0U);
  Recorder writing(test_device());
  relu(writing, a, {});
  relu(writing, a, {});  // the layer takes both for writes of the same bytes
  relu(writing, {}, b);  // reading it needs no order
  EXPECT_EQ(writing.finish()->barriers(), 1U);
}

TEST_F(RecorderTest, ReplaysGiveTheSameAndSeeNewInput) {
  const Slice a = allocate();
  const Slice b = allocate();
  const Slice c = allocate();
  Recorder recorder(test_device());
  relu(recorder, a, b);
  relu(recorder, b, c);
  const auto commands = recorder.finish();
  for (const float value : {-1.0F, 3.0F}) {
    upload_values<float>(test_device(), a, std::vector<float>(64, value));
    commands->run();
    EXPECT_EQ(read(c), std::vector<float>(64, value > 0 ? value : 4 * value));
  }
}

TEST_F(RecorderTest, FillsAndCopiesAreOrderedWithDispatches) {
  const Slice a = allocate();
  const Slice b = allocate();
  const Slice c = allocate();
  Recorder recorder(test_device());
  recorder.fill(a, 0x3f800000);  // 1.0F
  relu(recorder, a, b);
  recorder.copy(b, c);
  recorder.fill(b);
  const auto commands = recorder.finish();
  commands->run();
  EXPECT_EQ(read(c), std::vector<float>(64, 1.0F));
  EXPECT_EQ(read(b), std::vector<float>(64, 0.0F));
  EXPECT_EQ(commands->barriers(), 3U);
}

TEST_F(RecorderTest, LongRecordingsAreCutIntoChunks) {
  const Slice a = allocate();
  const Slice b = allocate();
  Recorder recorder(test_device());
  for (int i = 0; i < 4; ++i) {
    recorder.begin_section();
    recorder.expect_work(1e12);
    relu(recorder, a, b);
    recorder.end_section();
  }
  EXPECT_EQ(recorder.finish()->chunks(), 4U);
}

TEST_F(RecorderTest, TellsWhenEachCommandRan) {
  if (test_device().caps().timestamp_period == 0) GTEST_SKIP() << "the device has no timestamps";
  const Slice a = allocate();
  const Slice b = allocate();
  Recorder recorder(test_device(), true);
  recorder.fill(a);
  for (int i = 0; i < 2; ++i) {
    recorder.begin_section();
    recorder.expect_work(1e12);  // a chunk each
    relu(recorder, a, b);
    recorder.copy(b, a);
    recorder.end_section();
  }
  const auto commands = recorder.finish();
  for (int run = 0; run < 2; ++run) {
    const RunTimes host = commands->run();
    const auto times = commands->command_times();
    ASSERT_EQ(times.size(), 5U);
    double last = 0;
    for (size_t i = 0; i < times.size(); ++i) {
      const char* names[] = {"fill", "leaky_relu.forward", "copy", "leaky_relu.forward", "copy"};
      EXPECT_EQ(times[i].name, names[i]);
      EXPECT_EQ(times[i].section, static_cast<int>(i + 1) / 2 - 1);
      EXPECT_LE(last, times[i].begin);
      EXPECT_LE(times[i].begin, times[i].end);
      last = times[i].end;
    }
    EXPECT_LE(host.begin, host.submitted);
    EXPECT_LE(host.submitted, host.end);
  }
  Recorder plain(test_device());
  relu(plain, a, b);
  EXPECT_TRUE(plain.finish()->command_times().empty());
}

TEST_F(RecorderTest, RefusesWrongBindingsAndUnknownShaders) {
  const Slice a = allocate();
  Recorder recorder(test_device());
  EXPECT_THROW(recorder.dispatch_flat("leaky_relu.forward", 1, {a}, Push()), Error);
  EXPECT_THROW(recorder.dispatch_flat("no_such_shader", 1, {a}, Push()), Error);
}

TEST(TransferTest, RefusesMoreThanFits) {
  Arena arena(test_device(), MemoryKind::kDevice, "test");
  const std::vector<float> values(100, 1.0F);
  EXPECT_THROW(upload_values<float>(test_device(), arena.allocate(64), values), Error);
}

TEST(ArenaTest, SlicesAreAlignedAndApart) {
  Arena arena(test_device(), MemoryKind::kDevice, "test", 4096);
  const Slice a = arena.allocate(10);
  const Slice b = arena.allocate(3000);
  const Slice c = arena.allocate(3000);  // no room left in the first block
  EXPECT_EQ(b.offset % test_device().caps().offset_alignment, 0U);
  EXPECT_FALSE(a.overlaps(b));
  EXPECT_NE(b.buffer, c.buffer);
  EXPECT_THROW(arena.allocate(~uint64_t{0} / 2), Error);
}

}  // namespace
}  // namespace vkopple
