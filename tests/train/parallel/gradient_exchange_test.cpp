#include "train/parallel/gradient_exchange.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "runtime/error.h"
#include "tests/support/threaded_peers.h"

namespace vkopple {
namespace {

using Numbers = std::vector<float>;

TEST(GradientExchange, MeansComeByGroupWithoutACopy) {
  test::run_together(2, [](Peers& peers) {
    GradientExchange exchange(peers);
    const auto rank = static_cast<float>(peers.rank());
    for (int step = 0; step < 2; ++step) {
      Numbers depth{rank, 4 + rank}, object{10 * rank};
      const float* numbers = depth.data();
      exchange.begin("object", std::move(object));
      exchange.begin("depth", std::move(depth));
      const auto means = exchange.finish();
      ASSERT_EQ(means.size(), 2U);
      EXPECT_EQ(means.at("depth"), (Numbers{0.5F, 4.5F}));
      EXPECT_EQ(means.at("object"), Numbers{5});
      EXPECT_EQ(means.at("depth").data(), numbers);
    }
    EXPECT_TRUE(exchange.finish().empty());
  });
}

/// The second of two; slow, and what it throws comes while a third exchange waits.
class LostPeers : public Peers {
 public:
  int rank() const override { return 0; }
  int count() const override { return 2; }
  int exchanges() const { return exchanges_; }

 private:
  void all_gather(std::span<const float>, std::span<float>) override {}
  void all_to_all(std::span<const float>, std::span<float>) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (++exchanges_ == 2) throw Error("a process is gone");
  }

  int exchanges_ = 0;
};

TEST(GradientExchange, NoneComesAfterOneThatFailed) {
  LostPeers peers;
  GradientExchange exchange(peers);
  for (const char* group : {"depth", "object", "imagination"}) exchange.begin(group, Numbers(1000, 1));
  EXPECT_THROW(exchange.finish(), Error);
  EXPECT_EQ(peers.exchanges(), 2);
}

/// As where backward fails meanwhile: threads must not work on numbers that are gone.
TEST(GradientExchange, EndsWithWhatIsUnderWay) {
  LostPeers peers;
  {
    GradientExchange exchange(peers);
    exchange.begin("depth", Numbers(1000, 1));
    exchange.begin("object", Numbers(1000, 1));
  }
  EXPECT_EQ(peers.exchanges(), 2);
}

}  // namespace
}  // namespace vkopple
