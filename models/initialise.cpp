#include "models/initialise.h"

#include <cmath>
#include <numbers>
#include <random>

namespace vkopple {
namespace {

/// FNV-1a, so that a parameter's numbers depend on its name alone.
uint64_t hash(const std::string& text) {
  uint64_t h = 0xcbf29ce484222325U;
  for (char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return h;
}

/// Uniform in (0, 1). std's distributions differ from library to library; its engines don't.
double uniform(std::mt19937_64& random) { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; }

double normal(std::mt19937_64& random) {
  return std::sqrt(-2 * std::log(uniform(random))) * std::cos(2 * std::numbers::pi * uniform(random));
}

}  // namespace

Initial Initial::framework(int64_t fan_in) {
  return {Kind::kUniform, 1 / std::sqrt(static_cast<double>(fan_in))};
}

Initial Initial::kaiming_uniform(int64_t fan_in, double gain) {
  return {Kind::kUniform, gain * std::sqrt(3 / static_cast<double>(fan_in))};
}

Initial Initial::kaiming_normal(int64_t fan_in, double gain) {
  return {Kind::kNormal, gain / std::sqrt(static_cast<double>(fan_in))};
}

double leaky_gain() { return std::sqrt(2 / (1 + 0.1 * 0.1)); }

int64_t fan_in(const Shape& weight) { return weight.product(1, weight.rank()); }

std::vector<float> initial_values(const Initial& initial, int64_t count, uint64_t seed,
                                  const std::string& name) {
  std::mt19937_64 random(seed ^ hash(name));
  std::vector<float> values(static_cast<size_t>(count));
  for (float& v : values) {
    double draw = 1;
    if (initial.kind == Initial::Kind::kUniform) draw = 2 * uniform(random) - 1;
    if (initial.kind == Initial::Kind::kNormal) draw = normal(random);
    v = static_cast<float>(initial.scale * draw);
  }
  for (const Initial::Patch& patch : initial.patches) {
    for (int64_t i = 0; i < patch.count; ++i) {
      float& v = values.at(static_cast<size_t>(patch.first + i * patch.stride));
      v = static_cast<float>(patch.times * v + patch.plus);
    }
  }
  return values;
}

}  // namespace vkopple
