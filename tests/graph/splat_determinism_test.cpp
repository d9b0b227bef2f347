#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "graph/ops/splat.h"
#include "runtime/device.h"
#include "runtime/transfer.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using Floats = std::vector<float>;

struct Points {
  Shape shape;    ///< (B, S, H, W)
  Floats image;   ///< (B, 3, H, W)
  Floats uvd;     ///< (B, S, 3, H, W)
  Floats weight;  ///< (B, S, H, W)
};

size_t size(int64_t n) { return static_cast<size_t>(n); }

/// Random colours and weights of very different size, so that sums tell in which order they were taken.
Points random_points(const Shape& shape) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  const int64_t plane = shape[2] * shape[3];
  Points points{shape, Floats(size(shape[0] * 3 * plane)), Floats(size(shape.elements() * 3)),
                Floats(size(shape.elements()))};
  for (float& v : points.image) v = unit(random);
  for (float& v : points.weight) v = std::exp(10 * unit(random) - 5);
  return points;
}

/// Sets every point of hypothesis (b, s) at pixel number i to what `at` returns: u, v, d.
template <class At>
void place(Points& points, At at) {
  const int64_t plane = points.shape[2] * points.shape[3];
  for (int64_t n = 0; n < points.shape[0] * points.shape[1]; ++n)
    for (int64_t i = 0; i < plane; ++i) {
      const std::array<float, 3> uvd = at(n, i);
      for (int64_t axis = 0; axis < 3; ++axis) points.uvd[size((n * 3 + axis) * plane + i)] = uvd[size(axis)];
    }
}

struct Results {
  std::vector<Floats> outputs;    ///< image, depth, total
  std::vector<Floats> gradients;  ///< of uvd and weight, for output gradients of 1
};

Results run(const Device& device, const Points& points, float beta) {
  const Splat op(beta);
  const Shape& s = points.shape;
  const std::vector<TensorSpec> inputs{row_major(s.with(1, 3)), row_major({s[0], s[1], 3, s[2], s[3]}),
                                       row_major(s)};
  const Needs needs = op.needs(inputs, device.caps());
  Arena arena(device, MemoryKind::kDevice, "splat");
  const auto place_all = [&](const std::vector<TensorSpec>& specs, float value) {
    std::vector<Operand> operands;
    for (const TensorSpec& spec : specs) {
      operands.push_back({spec, arena.allocate(spec.bytes())});
      upload_values<float>(device, operands.back().slice, Floats(spec.bytes() / 4, value));
    }
    return operands;
  };
  const auto x = place_all(inputs, 0);
  upload_values<float>(device, x[0].slice, points.image);
  upload_values<float>(device, x[1].slice, points.uvd);
  upload_values<float>(device, x[2].slice, points.weight);
  const auto y = place_all(op.infer(inputs), 0);
  const auto saved = place_all(needs.saved, 0);
  const auto dy = place_all(op.infer(inputs), 1);
  auto dx = place_all(inputs, 0);
  dx[0].slice = {};
  const std::vector<uint8_t> accumulate(3, 0);
  Recorder recorder(device);
  op.record_forward(recorder, {x, y, saved, arena.allocate(needs.forward_scratch)});
  op.record_backward(recorder, {x, y, saved, dy, dx, accumulate, arena.allocate(needs.backward_scratch)});
  recorder.finish()->run();
  Results results;
  for (const Operand& o : y) results.outputs.push_back(download_values<float>(device, o.slice));
  for (size_t i : {1U, 2U}) results.gradients.push_back(download_values<float>(device, dx[i].slice));
  return results;
}

TEST(SplatDeterminismTest, TwoRunsGiveTheSameBitsWithEveryPointInOneCell) {
  Points points = random_points({2, 4, 40, 36});
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(0.1F, 0.9F);
  place(points, [&](int64_t, int64_t) {
    return std::array{unit(random) + 0.5F, unit(random) + 0.5F, 1 + unit(random)};
  });
  const Results first = run(test_device(), points, 1.0F);
  const Results second = run(test_device(), points, 1.0F);
  EXPECT_EQ(first.outputs, second.outputs);
  EXPECT_EQ(first.gradients, second.gradients);
}

TEST(SplatDeterminismTest, ListsOfAnyLengthAreSorted) {
  // The kernel alone: a device may happen to run threads in an order that needs no sorting.
  constexpr uint32_t kImages = 2, kSlots = 60, kSide = 15, kCells = (kSide + 1) * (kSide + 1);
  constexpr uint32_t kPoints = kSlots * kSide * kSide;
  std::mt19937 random(7);
  std::vector<uint32_t> starts;
  std::vector<uint32_t> lists;
  for (uint32_t image = 0; image < kImages; ++image) {
    uint32_t sum = 0;
    for (uint32_t cell = 0; cell < kCells; ++cell) {
      starts.push_back(sum);
      sum += (cell * 37 + image) % 103;
    }
    starts.push_back(sum);
    ASSERT_LE(sum, kPoints);
    for (uint32_t i = 0; i < kPoints; ++i) lists.push_back(i);
    std::shuffle(lists.end() - kPoints, lists.end(), random);
  }
  const Device& device = test_device();
  Arena arena(device, MemoryKind::kDevice, "lists");
  const Slice on_device[]{arena.allocate(starts.size() * 4), arena.allocate(lists.size() * 4)};
  upload_values<uint32_t>(device, on_device[0], starts);
  upload_values<uint32_t>(device, on_device[1], lists);
  Recorder recorder(device);
  recorder.dispatch_flat("splat_lists.sort", kImages * kCells, {on_device[0], on_device[1]},
                         std::array<uint32_t, 13>{kImages, kSlots, kSide, kSide, kCells});
  recorder.finish()->run();
  for (uint32_t image = 0; image < kImages; ++image)
    for (uint32_t cell = 0; cell < kCells; ++cell) {
      const auto at = [&](uint32_t c) {
        return lists.begin() + image * kPoints + starts[image * (kCells + 1) + c];
      };
      std::sort(at(cell), at(cell + 1));
    }
  EXPECT_EQ(download_values<uint32_t>(device, on_device[1]), lists);
}

TEST(SplatDeterminismTest, SumsGoThroughThePointsInAscendingOrder) {
  // Points exactly on the centre pixel, without fading by distance: every term of the total is a weight,
  // exactly.
  Points points = random_points({2, 3, 33, 35});
  place(points, [](int64_t, int64_t) { return std::array{0.0F, 0.0F, 1.0F}; });
  const Results results = run(test_device(), points, 0.0F);
  const size_t plane = 33 * 35;
  for (size_t b = 0; b < 2; ++b) {
    float total = 0;
    for (size_t i = 0; i < 3 * plane; ++i) total += points.weight[b * 3 * plane + i];
    EXPECT_EQ(results.outputs[2][b * plane + 16 * 35 + 17], total) << "image " << b;
  }
}

TEST(SplatDeterminismTest, ShortListsAreInAscendingOrderToo) {
  Points points = random_points({2, 20, 12, 13});
  place(points, [](int64_t, int64_t i) {
    return std::array{static_cast<float>(i % 13) - 6.0F, static_cast<float>(i / 13) - 5.5F, 1.0F};
  });
  const Results results = run(test_device(), points, 0.0F);
  const size_t plane = 12 * 13;
  for (size_t b = 0; b < 2; ++b)
    for (size_t i = 0; i < plane; ++i) {
      float total = 0;
      for (size_t s = 0; s < 20; ++s) total += points.weight[(b * 20 + s) * plane + i];
      EXPECT_EQ(results.outputs[2][b * plane + i], total) << "image " << b << ", pixel " << i;
    }
}

TEST(SplatDeterminismTest, PointsThatAreNotFiniteOrFarOutsideAreLost) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<std::array<float, 3>> lost{
      {kNaN, 0, 1},      {0, kNaN, 1},       {0, 0, kNaN},  {kInfinity, 0, 1}, {0, -kInfinity, 1},
      {0, 0, kInfinity}, {1e30F, 1e30F, 1},  {-3e9F, 0, 1}, {0, 5e9F, 1},      {3e38F, -3e38F, 3e38F},
      {0, 0, 0},         {0, 0, -kInfinity}, {6.01F, 0, 1}, {0, -5.51F, 1}};
  Points points = random_points({1, 2, 10, 11});
  // Hypothesis 0 stays in place, hypothesis 1 is lost in one way or another.
  place(points, [&](int64_t n, int64_t i) {
    return n == 1 ? lost[size(i) % lost.size()]
                  : std::array{static_cast<float>(i % 11) - 5.0F, static_cast<float>(i / 11) - 4.5F, 2.0F};
  });
  const size_t plane = 110;
  const Results results = run(test_device(), points, 1.0F);
  for (size_t i = 0; i < plane; ++i) {
    EXPECT_EQ(results.outputs[2][i], points.weight[i]) << "pixel " << i;
    EXPECT_NEAR(results.outputs[1][i], 2.0F, 1e-5F) << "pixel " << i;
  }
  for (size_t i = 0; i < plane; ++i) {
    EXPECT_EQ(results.gradients[1][plane + i], 0.0F) << "weight of lost point " << i;
    for (size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(results.gradients[0][(3 + axis) * plane + i], 0.0F) << "lost point " << i << ", axis " << axis;
  }
}

}  // namespace
}  // namespace vkopple
