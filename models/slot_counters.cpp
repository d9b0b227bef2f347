#include "models/slot_counters.h"

#include <cmath>

namespace vkopple {
namespace {

constexpr int64_t kGates = 4;            // i f g o
constexpr double kOpen = 6, kShut = -6;  // what a gate's bias makes of its sigmoid: 0.998 and 0.002
// The candidate of a unit that follows another: tanh of kStart before the other was ever on, of kStart + 0.757
// kFollow afterwards, which is about −1 and 1. h = ±0.757 then.
constexpr double kStart = -3, kFollow = 8;
constexpr double kOn = 3;
constexpr double kHeard = 0.4;  // standard deviation of the weights from a counter to the other units' gates
constexpr double kCodeSpread = 0.3;  // and to the components of the code that masks are made of
constexpr double kIdentity = 4, kIdentityBias = -1.36;  // 4 leaky(±0.757) − 1.36 = ±1.67

}  // namespace

SlotCounters slot_counters(const ModelConfig& config, int64_t features) {
  const int64_t hidden = config.lstm;
  SlotCounters x{.weight_ih = Initial::kaiming_normal(features, std::sqrt(2.0)),
                 .weight_hh = Initial::kaiming_normal(hidden, std::sqrt(2.0)),
                 .bias_ih = Initial::framework(hidden),
                 .bias_hh = Initial::framework(hidden),
                 .head_weight = Initial::framework(hidden),
                 .head_bias = Initial::framework(hidden)};
  if (config.slot_counters == 0) return x;
  const int64_t units = config.slot_counters + 1;

  // What the others hear of the counters: of unit 0, which never changes, nothing.
  for (int64_t unit = 0; unit < units; ++unit)
    x.weight_hh.patch({.first = unit,
                       .stride = hidden,
                       .count = kGates * hidden,
                       .times = unit == 0 ? 0 : kHeard / x.weight_hh.scale});
  for (int64_t gate = 0; gate < kGates; ++gate) {
    const int64_t row = gate * hidden;
    x.weight_ih.patch({.first = row * features, .count = units * features, .times = 0});
    x.weight_hh.patch({.first = row * hidden, .count = units * hidden, .times = 0});
    x.bias_hh.patch({.first = row, .count = units, .times = 0});
    const double bias = gate == 1 ? kShut : gate == 2 ? kStart : kOpen;
    x.bias_ih.patch({.first = row, .count = units, .times = 0, .plus = bias});
  }
  x.bias_ih.patch({.first = 2 * hidden, .count = 1, .times = 0, .plus = kOn});
  for (int64_t unit = 1; unit < units; ++unit)
    x.weight_hh.patch(
        {.first = (2 * hidden + unit) * hidden + unit - 1, .count = 1, .times = 0, .plus = kFollow});

  const int64_t identity = 3 + config.orientation_numbers();
  const int64_t mask_code = identity + config.identity, numbers = identity + config.code;
  const double spread = kCodeSpread * std::sqrt(3.0) / x.head_weight.scale;
  for (int64_t unit = 0; unit < units; ++unit) {
    x.head_weight.patch({.first = unit, .stride = hidden, .count = identity, .times = 0});
    x.head_weight.patch({.first = mask_code * hidden + unit,
                         .stride = hidden,
                         .count = numbers - mask_code,
                         .times = unit == 0 ? 0 : spread});
  }
  x.head_weight.patch({.first = identity * hidden, .count = config.identity * hidden, .times = 0});
  x.head_bias.patch({.first = identity, .count = config.identity, .times = 0});
  for (int64_t unit = 1; unit < units; ++unit) {
    x.head_weight.patch(
        {.first = (identity + unit - 1) * hidden + unit, .count = 1, .times = 0, .plus = kIdentity});
    x.head_bias.patch({.first = identity + unit - 1, .count = 1, .times = 0, .plus = kIdentityBias});
  }
  return x;
}

}  // namespace vkopple
