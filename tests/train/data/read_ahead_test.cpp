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
  std::atomic<bool> together{false};
};

/// Gives batches of as many triplets as the step's number; has none from step 5 on.
class Counting : public TripletSource {
 public:
  explicit Counting(Calls& calls) : calls_(&calls) {}

  TripletBatch read(uint64_t step) override {
    if (++calls_->running > 1) calls_->together = true;
    ++calls_->count;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    --calls_->running;
    if (step >= 5) throw Error("nothing there");
    TripletBatch batch;
    batch.batch = static_cast<int>(step);
    return batch;
  }
  std::optional<uint64_t> size() const override { return 7; }

 private:
  Calls* calls_;
};

class ReadAheadTest : public testing::Test {
 protected:
  void expect_calls(int count) const {
    for (int i = 0; i < 2000 && calls_.count < count; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(calls_.count, count);
  }

  Calls calls_;
  ReadAhead source_{std::make_unique<Counting>(calls_)};
};

TEST_F(ReadAheadTest, GivesWhatTheSourceGivesInAnyOrder) {
  for (const int step : {0, 1, 2, 4, 1, 1, 3}) EXPECT_EQ(source_.read(static_cast<uint64_t>(step)).batch, step);
  EXPECT_FALSE(calls_.together);
  EXPECT_EQ(source_.size(), 7U);
}

TEST_F(ReadAheadTest, ReadsTheNextStepUnasked) {
  source_.read(2);
  expect_calls(2);  // 2, and 3 in the background
  source_.read(3);
  expect_calls(3);  // 4
}

TEST_F(ReadAheadTest, AnErrorComesAtTheStepItBelongsTo) {
  EXPECT_EQ(source_.read(4).batch, 4);  // while 5 fails
  EXPECT_THROW(source_.read(5), Error);
  EXPECT_THROW(source_.read(5), Error);
  EXPECT_EQ(source_.read(0).batch, 0);
}

}  // namespace
}  // namespace vkopple
