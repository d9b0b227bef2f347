#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "runtime/device.h"
#include "runtime/recorder.h"
#include "runtime/transfer.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

struct ProbePush {
  uint32_t count;
  uint32_t function;
};

std::vector<float> probe(uint32_t function, const std::vector<float>& a, const std::vector<float>& b) {
  const Device& device = test_device();
  Arena arena(device, MemoryKind::kDevice, "probe");
  const uint64_t bytes = a.size() * sizeof(float);
  const Slice sa = arena.allocate(bytes);
  const Slice sb = arena.allocate(bytes);
  const Slice sy = arena.allocate(bytes);
  upload_values<float>(device, sa, a);
  upload_values<float>(device, sb, b);
  Recorder recorder(device);
  recorder.dispatch_flat("precise_probe", a.size(), {sa, sb, sy},
                         ProbePush{static_cast<uint32_t>(a.size()), function});
  recorder.finish()->run();
  return download_values<float>(device, sy);
}

struct Range {
  float low;
  float high;
};

std::vector<float> draw(std::mt19937& random, Range range) {
  std::vector<float> values(20000);
  for (float& v : values)
    v = range.low + (range.high - range.low) * (static_cast<float>(random() >> 8) / 16777216.0F);
  return values;
}

struct Function {
  const char* name;
  uint32_t id;
  std::function<double(double, double)> truth;
  Range a;
  Range b = {1, 1};
  double relative = 2e-7;  ///< allowed where `absolute` is exceeded
  double absolute = 0;
};

const double kTurn = 2 * std::numbers::pi;
const auto kExp = [](double x, double) { return std::exp(x); };
const auto kLog = [](double x, double) { return std::log(x); };
const auto kCos = [](double x, double) { return std::cos(x); };
const auto kSin = [](double x, double) { return std::sin(x); };
const auto kAtan = [](double y, double x) { return std::atan2(y, x); };
const auto kSigmoid = [](double x, double) { return 1 / (1 + std::exp(-x)); };

class PreciseFunctionTest : public testing::TestWithParam<Function> {};

TEST_P(PreciseFunctionTest, IsAsCloseAsFloatsAllow) {
  const Function& f = GetParam();
  std::mt19937 random(5);
  const auto a = draw(random, f.a);
  const auto b = draw(random, f.b);
  const auto y = probe(f.id, a, b);
  for (size_t i = 0; i < a.size(); ++i) {
    const double truth = f.truth(static_cast<double>(a[i]), static_cast<double>(b[i]));
    const double error = std::abs(static_cast<double>(y[i]) - truth);
    ASSERT_TRUE(error <= f.absolute + f.relative * std::abs(truth))
        << f.name << "(" << a[i] << ", " << b[i] << ") is " << y[i] << ", should be " << truth;
  }
}

INSTANTIATE_TEST_SUITE_P(Ranges, PreciseFunctionTest,
                         testing::Values(Function{"exp", 0, kExp, {-1, 1}},
                                         Function{"exp_wide", 0, kExp, {-87.3F, 88.7F}},
                                         Function{"log", 1, kLog, {1e-5F, 10}},
                                         Function{"log_near_1", 1, kLog, {0.99F, 1.01F}},
                                         Function{"log_large", 1, kLog, {2, 1e30F}},
                                         Function{"cos", 2, kCos, {-1000, 1000}, {1, 1}, 0, 1e-7},
                                         Function{"sin", 3, kSin, {-1000, 1000}, {1, 1}, 0, 1e-7},
                                         Function{"sin_near_0", 3, kSin, {-0.01F, 0.01F}},
                                         Function{"atan2", 4, kAtan, {-1, 1}, {-1, 1}, 2.5e-7},
                                         Function{"atan2_steep", 4, kAtan, {-1, 1}, {-0.001F, 0.001F}, 2.5e-7},
                                         Function{"atan2_flat", 4, kAtan, {-0.001F, 0.001F}, {-1, 1}, 2.5e-7},
                                         Function{"sigmoid", 5, kSigmoid, {-30, 30}}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(PreciseTest, StepsOfATurn) {
  for (int steps : {1, 2, 3, 4, 7, 120, 121, 360}) {
    std::vector<float> step;
    for (int i = 0; i < steps; ++i) step.push_back(static_cast<float>(i));
    const std::vector<float> all(step.size(), static_cast<float>(steps));
    const auto c = probe(6, step, all);
    const auto s = probe(7, step, all);
    for (size_t i = 0; i < step.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(c[i]), std::cos(kTurn * static_cast<double>(i) / steps), 1e-7) << steps;
      EXPECT_NEAR(static_cast<double>(s[i]), std::sin(kTurn * static_cast<double>(i) / steps), 1e-7) << steps;
    }
  }
}

TEST(PreciseTest, ProductsAndWhatTheyRoundOffAreExact) {
  std::mt19937 random(6);
  const auto a = draw(random, {-3, 3});
  const auto b = draw(random, {-700, 700});
  const auto rest = probe(8, a, b);
  size_t some = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double exact = static_cast<double>(a[i]) * static_cast<double>(b[i]);  // 48 bits
    ASSERT_EQ(static_cast<double>(rest[i]), exact - static_cast<double>(a[i] * b[i])) << a[i] << " * " << b[i];
    some += rest[i] != 0 ? 1 : 0;
  }
  EXPECT_GT(some, a.size() / 2);
}

TEST(PreciseTest, EdgesAreThoseOfTheMathLibrary) {
  const float infinite = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> x = {-infinite, -200, 0, 1, 200, infinite, nan};
  const auto e = probe(0, x, x);
  const auto l = probe(1, x, x);
  for (size_t i = 0; i < x.size(); ++i) {
    const auto same = [](float a, float b) {
      return std::isnan(a)   ? std::isnan(b)
             : std::isinf(a) ? a == b
                             : std::abs(a - b) < 3e-7F * (1 + std::abs(a));
    };
    EXPECT_PRED2(same, std::exp(x[i]) < 1e-37F ? 0.0F : std::exp(x[i]), e[i]) << "exp " << x[i];
    EXPECT_PRED2(same, std::log(x[i]), l[i]) << "log " << x[i];
  }
}

}  // namespace
}  // namespace vkopple
