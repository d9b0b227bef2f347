#include "train/report/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace vkopple {
namespace {

constexpr std::array<double, 3> kRound{1, 2, 5};
constexpr double kLargest = 1e100,
                 kLeast = 1e-100;  // beyond which ranges and their powers of ten are no numbers
constexpr double kManyTimes = 30;  // from which on a logarithmic axis shows more
constexpr std::size_t kMostLogTicks = 7;

/// The round number just at or above a positive one.
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : kRound)
    if (factor * power >= value * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

}  // namespace

Axis Axis::linear(double low, double high, int wanted) {
  if (low > high) std::swap(low, high);
  low = std::clamp(low, -kLargest, kLargest);
  high = std::clamp(high, -kLargest, kLargest);
  if (high - low <= std::max(1e-9 * std::max(std::abs(low), std::abs(high)), kLeast)) {
    const double room = std::abs(low) <= kLeast ? 1 : std::abs(low) / 2;
    low -= room;
    high += room;
  }
  const double step = round_up((high - low) / wanted);
  std::vector<double> ticks;
  const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
  for (double n = first; n <= last; ++n) ticks.push_back(n * step);
  return {std::move(ticks), false};
}

Axis Axis::within(double low, double high, int wanted) {
  Axis axis = linear(low, high, wanted);
  axis.low_ = low;
  axis.high_ = high;
  std::erase_if(axis.ticks_, [&](double tick) { return tick < low || tick > high; });
  return axis;
}

Axis Axis::logarithmic(double low, double high) {
  if (low > high) std::swap(low, high);
  low = std::clamp(low, kLeast, kLargest);
  high = std::clamp(high, kLeast, kLargest);
  std::vector<double> ticks, powers;
  for (double power = std::floor(std::log10(low)); power <= std::ceil(std::log10(high)); ++power) {
    powers.push_back(std::pow(10.0, power));
    for (const double factor : kRound) ticks.push_back(factor * powers.back());
  }
  while (ticks.size() > 2 && ticks[1] <= low) ticks.erase(ticks.begin());
  while (ticks.size() > 2 && ticks[ticks.size() - 2] >= high) ticks.pop_back();
  if (ticks.size() <= kMostLogTicks) return {std::move(ticks), true};
  const std::size_t every = (powers.size() + kMostLogTicks - 1) / kMostLogTicks;
  std::vector<double> kept;
  for (std::size_t i = 0; i < powers.size(); i += every) kept.push_back(powers[i]);
  if (kept.back() < high) kept.push_back(kept.back() * std::pow(10.0, static_cast<double>(every)));
  return {std::move(kept), true};
}

Axis Axis::fitting(double low, double high) {
  if (low > high) std::swap(low, high);
  return low > 0 && high / low > kManyTimes ? logarithmic(low, high) : linear(low, high);
}

double Axis::place(double value) const {
  if (logarithmic_) return std::log(std::max(value, kLeast) / low()) / std::log(high() / low());
  return (value - low()) / (high() - low());
}

std::string Axis::label(double tick) const {
  const double largest = std::max(std::abs(low()), std::abs(high()));
  if (largest >= 1e6 || largest < 1e-3) return fmt::format("{:.3g}", tick);
  if (logarithmic_) return fmt::format("{:g}", tick);
  const double step = ticks_[1] - ticks_[0];
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const std::string text = fmt::format("{:.{}f}", std::abs(tick) < step / 2 ? 0.0 : tick, digits);
  return text.starts_with('-') ? "\u2212" + text.substr(1) : text;
}

}  // namespace vkopple
