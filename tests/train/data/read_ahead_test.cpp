#include "train/data/read_ahead.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "runtime/error.h"

namespace vkopple {
namespace {

/// What a source was asked for.
struct Calls {
  std::atomic<int> count{0};
  std::atomic<int> running{0};
  std::atomic<int> most_together{0};
};

/// Gives batches of as many triplets as the step's number, later steps sooner; has none from step 20 on.
class Counting : public TripletSource {
 public:
  explicit Counting(Calls& calls) : calls_(&calls) {}

  TripletBatch read(uint64_t /*step*/) override { throw Error("read ahead is what is shown"); }
  TripletBatch read_shown(uint64_t step) override {
    const int running = ++calls_->running;
    for (int most = calls_->most_together;
         most < running && !calls_->most_together.compare_exchange_weak(most, running);) {
    }
    ++calls_->count;
    std::this_thread::sleep_for(std::chrono::milliseconds(step % 2 == 0 ? 4 : 1));
    --calls_->running;
    if (step >= 20) throw Error("nothing there");
    TripletBatch batch;
    batch.batch = static_cast<int>(step);
    return batch;
  }
  std::optional<uint64_t> size() const override { return 7; }

 private:
  Calls* calls_;
};

void expect_calls(const Calls& calls, int count) {
  for (int i = 0; i < 2000 && calls.count < count; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(calls.count, count);
}

class ReadAheadTest : public testing::TestWithParam<int> {
 protected:
  int threads() const { return GetParam(); }

  Calls calls_;
  ReadAhead source_{std::make_unique<Counting>(calls_), GetParam()};
};

TEST_P(ReadAheadTest, GivesWhatTheSourceGivesInAnyOrder) {
  for (const int step : {0, 1, 2, 3, 4, 5, 9, 11, 1, 1, 3})
    EXPECT_EQ(source_.read_shown(static_cast<uint64_t>(step)).batch, step);
  EXPECT_LE(calls_.most_together, threads());
  EXPECT_EQ(source_.size(), 7U);
}

TEST_P(ReadAheadTest, ReadsTheNextStepsUnasked) {
  source_.read_shown(2);
  expect_calls(calls_, 1 + threads());
  source_.read_shown(3);
  expect_calls(calls_, 2 + threads());
}

TEST_P(ReadAheadTest, AnErrorComesAtTheStepItBelongsTo) {
  EXPECT_EQ(source_.read_shown(18).batch, 18);  // while 20 fails
  EXPECT_EQ(source_.read_shown(19).batch, 19);
  EXPECT_THROW(source_.read_shown(20), Error);
  EXPECT_THROW(source_.read_shown(20), Error);
  EXPECT_EQ(source_.read_shown(0).batch, 0);
}

TEST_P(ReadAheadTest, StepsOfSeveralThreadsAreReadTogether) {
  for (uint64_t step = 0; step < 10; ++step) source_.read_shown(step);
  EXPECT_EQ(calls_.most_together > 1, threads() > 1);
}

INSTANTIATE_TEST_SUITE_P(Threads, ReadAheadTest, testing::Values(1, 2, 5));

}  // namespace
}  // namespace vkopple
