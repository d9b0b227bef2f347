#include "graph/parallel/shared_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "tests/support/threaded_peers.h"

// What the host makes of the partials of batch norms, against the values that they stand for.

namespace vkopple {
namespace {

constexpr int kProcesses = 3;
constexpr size_t kLanes = 4;
/// The last strips of an entry have fewer items than the others, the very last none.
constexpr NormStrips kStrips{
    .items = 19, .strips = 8, .lanes = 2, .each = 4, .blocks = 2, .groups = 3, .channels = 8};
constexpr size_t kEntries = size_t{kStrips.groups} * kStrips.blocks;

/// Item `item` of a process, entry and lane: a mean that float's digits end at, and small differences.
double value(int process, size_t entry, size_t lane, uint32_t item) {
  return 1000.0 * static_cast<double>(lane) + static_cast<double>(process) + 0.3 * static_cast<double>(entry) +
         std::sin(0.9 * item + process);
}

/// Items of strip q, as shaders/include/norm_strips.glsl shares them out.
std::vector<uint32_t> items_of(const NormStrips& s, uint32_t q) {
  std::vector<uint32_t> items;
  uint32_t item = (q >> s.lanes) * (s.each << s.lanes) + q % (1U << s.lanes);
  for (uint32_t i = 0; i < s.each && item < s.items; ++i, item += 1U << s.lanes) items.push_back(item);
  return items;
}

struct Moments {
  double mean = 0, squares = 0;
};

Moments moments(const std::vector<double>& values) {
  Moments m;
  for (const double v : values) m.mean += v / static_cast<double>(values.size());
  for (const double v : values) m.squares += (v - m.mean) * (v - m.mean);
  return m;
}

std::vector<float> statistics_of(int process) {
  std::vector<float> partials;
  for (size_t entry = 0; entry < kEntries; ++entry)
    for (uint32_t q = 0; q < kStrips.strips; ++q) {
      std::vector<float> strip(3 * kLanes);
      for (size_t lane = 0; lane < kLanes; ++lane) {
        std::vector<double> values;
        for (const uint32_t item : items_of(kStrips, q)) values.push_back(value(process, entry, lane, item));
        const Moments m = moments(values);
        strip[lane] = static_cast<float>(m.mean);
        strip[kLanes + lane] = static_cast<float>(m.squares);
        strip[2 * kLanes + lane] = static_cast<float>(m.mean - double{strip[lane]});
      }
      partials.insert(partials.end(), strip.begin(), strip.end());
    }
  return partials;
}

TEST(SharedStatistics, StripsStandForTheValuesOfAll) {
  test::run_together(kProcesses, [](Peers& peers) {
    std::vector<float> partials = statistics_of(peers.rank());
    share_statistics(peers, kStrips, partials);
    const NormStrips shared = shared_strips(kStrips, kProcesses);
    for (size_t entry = 0; entry < kEntries; ++entry)
      for (size_t lane = 0; lane < kLanes; ++lane) {
        std::vector<double> all;
        for (int process = 0; process < kProcesses; ++process)
          for (uint32_t item = 0; item < kStrips.items; ++item)
            all.push_back(value(process, entry, lane, item));
        const Moments wanted = moments(all);
        // As batch_norm_finish adds strips up.
        double items = 0, mean = 0, squares = 0;
        for (uint32_t q = 0; q < shared.strips; ++q) {
          const float* strip = &partials[(entry * shared.strips + q) * 3 * kLanes + lane];
          const auto count = static_cast<double>(items_of(shared, q).size());
          items += count;
          mean += count * (double{strip[0]} + double{strip[2 * kLanes]});
          squares += double{strip[kLanes]};
          EXPECT_EQ(strip[0], partials[entry * shared.strips * 3 * kLanes + lane]);
        }
        EXPECT_EQ(items, kProcesses * kStrips.items);
        EXPECT_NEAR(mean / items, wanted.mean, 1e-10 * std::fabs(wanted.mean) + 1e-9);
        EXPECT_NEAR(squares, wanted.squares, 2e-7 * wanted.squares);
      }
  });
}

TEST(SharedStatistics, SumsAreMeansOverProcesses) {
  constexpr size_t kFloats = 2 * kLanes;
  const auto number = [](int process, size_t entry, size_t strip, size_t i) {
    return static_cast<float>(std::sin(1.7 * static_cast<double>(entry) + 0.6 * static_cast<double>(strip) +
                                       0.2 * static_cast<double>(i) + process));
  };
  test::run_together(kProcesses, [&](Peers& peers) {
    std::vector<float> partials;
    for (size_t entry = 0; entry < kEntries; ++entry)
      for (size_t q = 0; q < kStrips.strips; ++q)
        for (size_t i = 0; i < kFloats; ++i) partials.push_back(number(peers.rank(), entry, q, i));
    share_sums(peers, kStrips, partials);
    for (size_t entry = 0; entry < kEntries; ++entry)
      for (size_t i = 0; i < kFloats; ++i) {
        double sum = 0, wanted = 0;
        for (size_t q = 0; q < kStrips.strips; ++q) {
          sum += double{partials[(entry * kStrips.strips + q) * kFloats + i]};
          for (int process = 0; process < kProcesses; ++process)
            wanted += double{number(process, entry, q, i)} / kProcesses;
        }
        EXPECT_NEAR(sum, wanted, 1e-6);
      }
  });
}

/// Alone, and counts what it would send.
class CountingPeers : public Peers {
 public:
  int rank() const override { return 0; }
  int count() const override { return 1; }
  size_t sent() const { return sent_; }

 private:
  void all_gather(std::span<const float> mine, std::span<float> all) override { send(mine, all); }
  void all_to_all(std::span<const float> parts, std::span<float> mine) override { send(parts, mine); }
  void send(std::span<const float> from, std::span<float> to) {
    sent_ = std::max(sent_, from.size());
    std::copy(from.begin(), from.end(), to.begin());
  }

  size_t sent_ = 0;
};

TEST(SharedStatistics, AStripOfEveryEntryIsSent) {
  CountingPeers of_forward, of_backward;
  std::vector<float> partials = statistics_of(0);
  share_statistics(of_forward, kStrips, partials);
  EXPECT_EQ(of_forward.sent(), kEntries * 3 * kLanes);
  partials.resize(kEntries * kStrips.strips * 2 * kLanes);
  share_sums(of_backward, kStrips, partials);
  EXPECT_EQ(of_backward.sent(), kEntries * 2 * kLanes);
}

}  // namespace
}  // namespace vkopple
