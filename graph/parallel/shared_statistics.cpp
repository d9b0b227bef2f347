#include "graph/parallel/shared_statistics.h"

#include <algorithm>
#include <vector>

namespace vkopple {
namespace {

constexpr size_t kLanes = 4;
constexpr size_t kStripFloats = 3 * kLanes;  ///< means, squares, low parts of the means
constexpr size_t kSumFloats = 2 * kLanes;    ///< of a strip in backward: two sums

/// As strip_count() of shaders/include/norm_strips.glsl.
uint32_t strip_count(const NormStrips& s, uint32_t q) {
  const uint32_t first = (q >> s.lanes) * (s.each << s.lanes) + (q & ((1U << s.lanes) - 1));
  return first < s.items ? std::min(s.each, ((s.items - 1 - first) >> s.lanes) + 1) : 0;
}

struct Moments {
  double mean = 0;
  double squares = 0;  ///< about the mean
};

/// Of the values that strips of `runs` (one a process) stand for, in one lane.
Moments combine(const NormStrips& s, std::span<const float> gathered, size_t run_floats, size_t at) {
  const size_t runs = gathered.size() / run_floats;
  const auto each = [&](auto&& visit) {
    for (size_t run = 0; run < runs; ++run)
      for (uint32_t q = 0; q < s.strips; ++q) {
        const float* strip = &gathered[run * run_floats + at + q * kStripFloats];
        const uint32_t count = strip_count(s, q);
        if (count > 0) visit(count, double{strip[0]} + double{strip[2 * kLanes]}, double{strip[kLanes]});
      }
  };
  const double items = static_cast<double>(s.items) * static_cast<double>(runs);
  Moments all;
  each([&](double count, double mean, double) { all.mean += count / items * mean; });
  each([&](double count, double mean, double squares) {
    all.squares += squares + count * (mean - all.mean) * (mean - all.mean);
  });
  return all;
}

/// In one lane of a strip.
void store(const Moments& moments, float* strip) {
  strip[0] = static_cast<float>(moments.mean);
  strip[kLanes] = static_cast<float>(moments.squares);
  strip[2 * kLanes] = static_cast<float>(moments.mean - double{strip[0]});
}

/// A strip for all items of an entry.
NormStrips joined(const NormStrips& strips) {
  NormStrips one = strips;
  one.strips = 1;
  one.lanes = 0;
  one.each = strips.items;
  return one;
}

size_t entries_of(const NormStrips& strips) { return size_t{strips.groups} * strips.blocks; }

}  // namespace

NormStrips shared_strips(const NormStrips& strips, int processes) {
  NormStrips shared = strips;
  shared.items *= static_cast<uint32_t>(processes);
  shared.each *= static_cast<uint32_t>(processes);
  return shared;
}

void share_statistics(Peers& peers, const NormStrips& strips, std::span<float> partials) {
  const size_t entries = entries_of(strips), entry_floats = strips.strips * kStripFloats;
  std::vector<float> own(entries * kStripFloats);
  for (size_t entry = 0; entry < entries; ++entry)
    for (size_t lane = 0; lane < kLanes; ++lane)
      store(combine(strips, partials, partials.size(), entry * entry_floats + lane),
            &own[entry * kStripFloats + lane]);
  const std::vector<float> gathered = peers.gather(own);
  const NormStrips one = joined(strips);
  for (size_t entry = 0; entry < entries; ++entry)
    for (size_t lane = 0; lane < kLanes; ++lane) {
      Moments all = combine(one, gathered, own.size(), entry * kStripFloats + lane);
      // Every strip has the mean, the first has all squares.
      for (uint32_t q = 0; q < strips.strips; ++q) {
        store(all, &partials[entry * entry_floats + q * kStripFloats + lane]);
        all.squares = 0;
      }
    }
}

void share_sums(Peers& peers, const NormStrips& strips, std::span<float> partials) {
  const size_t entries = entries_of(strips), entry_floats = strips.strips * kSumFloats;
  std::vector<float> sums(entries * kSumFloats);
  for (size_t i = 0; i < sums.size(); ++i) {
    const size_t first = i / kSumFloats * entry_floats + i % kSumFloats;
    double sum = 0;
    for (uint32_t q = 0; q < strips.strips; ++q) sum += double{partials[first + q * kSumFloats]};
    sums[i] = static_cast<float>(sum);
  }
  peers.average(sums);
  std::fill(partials.begin(), partials.end(), 0.0F);
  for (size_t entry = 0; entry < entries; ++entry)
    std::copy_n(&sums[entry * kSumFloats], kSumFloats, &partials[entry * entry_floats]);
}

}  // namespace vkopple
