#include "graph/parallel/shared_statistics.h"

#include <algorithm>
#include <vector>

namespace vkopple {
namespace {

constexpr size_t kLanes = 4;
constexpr size_t kStripFloats = 3 * kLanes;  ///< means, squares, low parts of the means

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

}  // namespace

NormStrips shared_strips(const NormStrips& strips, int processes) {
  NormStrips shared = strips;
  shared.items *= static_cast<uint32_t>(processes);
  shared.each *= static_cast<uint32_t>(processes);
  return shared;
}

void share_statistics(Peers& peers, const NormStrips& strips, std::span<float> partials) {
  const std::vector<float> gathered = peers.gather(partials);
  const size_t entry_floats = strips.strips * kStripFloats;
  for (size_t entry = 0; entry < partials.size(); entry += entry_floats)
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const Moments all = combine(strips, gathered, partials.size(), entry + lane);
      const auto mean = static_cast<float>(all.mean);
      const auto low = static_cast<float>(all.mean - double{mean});
      // Every strip has the mean, the first has all squares.
      for (uint32_t q = 0; q < strips.strips; ++q) {
        float* strip = &partials[entry + q * kStripFloats + lane];
        strip[0] = mean;
        strip[kLanes] = q == 0 ? static_cast<float>(all.squares) : 0.0F;
        strip[2 * kLanes] = low;
      }
    }
}

}  // namespace vkopple
