#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "graph/executor.h"
#include "graph/ops/batch_norm.h"
#include "graph/ops/gather_batch.h"
#include "graph/ops/image_loss.h"
#include "graph/ops/relayout.h"
#include "tests/support/test_device.h"
#include "tests/support/threaded_peers.h"

// What graphs compute whose batches lie in several processes, against one with the whole batch.

namespace vkopple {
namespace {

using Numbers = std::vector<float>;

constexpr int64_t kSide = 5, kChannels = 6, kGroups = 2;
constexpr int64_t kBatch = 4;  ///< samples of a group, of all processes
constexpr int64_t kSample = kChannels * kSide * kSide;

Numbers wave(int64_t count, double offset) {
  Numbers values;
  for (int64_t i = 0; i < count; ++i)
    values.push_back(
        static_cast<float>(std::sin(0.7 * static_cast<double>(i) + offset) + 0.1 * static_cast<double>(i % 7)));
  return values;
}

/// Of (kGroups, kBatch) samples those of a process: in every group its part of the batch.
Numbers part_of(const Numbers& all, int64_t samples_each, const Peers* peers) {
  const int64_t count = peers == nullptr ? 1 : peers->count(), rank = peers == nullptr ? 0 : peers->rank();
  const int64_t part = kBatch / count;
  Numbers own;
  for (int64_t g = 0; g < kGroups; ++g) {
    const auto begin = all.begin() + (g * kBatch + rank * part) * samples_each;
    own.insert(own.end(), begin, begin + part * samples_each);
  }
  return own;
}

std::unique_ptr<Device> own_device() {
  return std::make_unique<Device>(DeviceOptions{.selector = "", .on_message = fail_test});
}

/// Output, gradients and running averages of a batch norm whose loss is the image loss against another wave.
std::map<std::string, Numbers> normalise(const Device& device, Peers* peers) {
  const int64_t samples = kGroups * kBatch / (peers == nullptr ? 1 : peers->count());
  Graph graph;
  const TensorSpec spec = row_major({samples, kChannels, kSide, kSide});
  const Value x = graph.parameter("x", "x", spec.shape);
  const Value gamma = graph.parameter("norm", "gamma", {kChannels});
  const Value beta = graph.parameter("norm", "beta", {kChannels});
  const Value mean = graph.state("averages", "mean", row_major({kChannels}));
  const Value variance = graph.state("averages", "variance", row_major({kChannels}));
  const Value target = graph.input("target", spec);
  BatchNormOptions options{};
  options.groups = kGroups;
  options.slope = 0.1F;
  options.peers = peers;
  const Value y = to_row_major(batch_norm(to_channels4(x), gamma, beta, mean, variance, {}, options));
  graph.keep("y", y);
  Executor executor(device, graph, {.loss = image_loss(y, target), .trained = {"x", "norm"}});
  executor.write(x, part_of(wave(kGroups * kBatch * kSample, 0.3), kSample, peers));
  executor.write(target, part_of(wave(kGroups * kBatch * kSample, 1.9), kSample, peers));
  executor.write(gamma, wave(kChannels, 0.2));
  executor.write(beta, wave(kChannels, 0.9));
  executor.write(mean, wave(kChannels, 0.4));
  executor.write(variance, Numbers(kChannels, 2));
  executor.forward();
  executor.backward();
  return {{"y", executor.read(y)},
          {"dx", executor.read_gradient(x)},
          {"dgamma", executor.read_gradient(gamma)},
          {"dbeta", executor.read_gradient(beta)},
          {"mean", executor.read(mean)},
          {"variance", executor.read(variance)}};
}

void expect_near(const Numbers& got, const Numbers& wanted, const std::string& what) {
  ASSERT_EQ(got.size(), wanted.size()) << what;
  double largest = 0;
  for (const float v : wanted) largest = std::fmax(largest, std::fabs(v));
  for (size_t i = 0; i < got.size(); ++i) ASSERT_NEAR(got[i], wanted[i], 3e-6 * largest) << what << " " << i;
}

TEST(SharedBatch, BatchNormsOfProcessesTakeTheStatisticsOfAll) {
  const auto whole = normalise(test_device(), nullptr);
  for (const int count : {2, 4})
    test::run_together(count, [&](Peers& peers) {
      const auto device = own_device();
      auto own = normalise(*device, &peers);
      // Losses are means over a process's batch.
      for (const char* gradient : {"dgamma", "dbeta"}) peers.average(own.at(gradient));
      for (float& v : own.at("dx")) v /= static_cast<float>(count);
      for (const char* name : {"y", "dx"})
        expect_near(own.at(name), part_of(whole.at(name), kSample, &peers), name);
      for (const char* name : {"dgamma", "dbeta", "mean", "variance"})
        expect_near(own.at(name), whole.at(name), name);
      // Weights would drift apart otherwise.
      const Numbers means = peers.gather(own.at("mean")), variances = peers.gather(own.at("variance"));
      for (size_t i = 0; i < means.size(); ++i) {
        EXPECT_EQ(means[i], own.at("mean")[i % kChannels]);
        EXPECT_EQ(variances[i], own.at("variance")[i % kChannels]);
      }
    });
}

TEST(SharedBatch, GatheredBatchesAreWholeAndGiveBackTheirPart) {
  constexpr int64_t kRows = 4, kColumns = 3;
  test::run_together(2, [](Peers& peers) {
    const auto device = own_device();
    Graph graph;
    const Value x = graph.parameter("x", "x", {kRows / 2, kColumns});
    const Value all = gather_batch(x, &peers);
    const Value target = graph.input("target", row_major({kRows, kColumns, 1, 1}));
    graph.keep("all", all);
    const Value pictures = graph.reshape(all, row_major({kRows, kColumns, 1, 1}));
    Executor executor(*device, graph, {.loss = image_loss(pictures, target), .trained = {"x"}});
    const Numbers whole = wave(kRows * kColumns, 0), wanted = wave(kRows * kColumns, 2);
    const auto own = static_cast<std::ptrdiff_t>(peers.rank() * kRows / 2 * kColumns);
    const Numbers part(whole.begin() + own, whole.begin() + own + kRows / 2 * kColumns);
    executor.write(x, part);
    executor.write(target, wanted);
    executor.forward();
    executor.backward();
    EXPECT_EQ(executor.read(all), whole);
    const Numbers dx = executor.read_gradient(x);
    for (size_t i = 0; i < dx.size(); ++i) {
      const size_t at = static_cast<size_t>(own) + i;
      // The mean over rows, twice as a process has half of them.
      EXPECT_NEAR(dx[i], 2 * 2 * (whole[at] - wanted[at]) / kRows, 1e-6) << i;
    }
  });
}

}  // namespace
}  // namespace vkopple
