#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graph/shape.h"

namespace vkopple {

/// How a parameter starts (docs/model.md §2). fan_in counts as PyTorch does: the second size times the kernel's
/// area.
struct Initial {
  enum class Kind { kUniform, kNormal, kConstant };
  /// `count` values from `first` on, `stride` apart: each becomes times · what was drawn + plus.
  struct Patch {
    int64_t first = 0, stride = 1, count = 0;
    double times = 1, plus = 0;
  };
  Kind kind = Kind::kConstant;
  double scale = 0;  ///< half-width of the uniform interval around 0, standard deviation, or the constant
  std::vector<Patch> patches = {};  ///< in turn, each upon what those before it left

  void patch(const Patch& p) { patches.push_back(p); }

  static Initial constant(double value) { return {Kind::kConstant, value}; }
  /// U(±1/√fan_in): the framework default of biases, and of weights.
  static Initial framework(int64_t fan_in);
  /// Kaiming with the given gain: U(±gain √(3 / fan_in)) or N(0, gain² / fan_in).
  static Initial kaiming_uniform(int64_t fan_in, double gain);
  static Initial kaiming_normal(int64_t fan_in, double gain);
};

/// √(2 / (1 + 0.1²)), the gain of a LeakyReLU of slope 0.1.
double leaky_gain();
int64_t fan_in(const Shape& weight);

/// Values of a parameter; the same for the same seed and name, whatever else the model has.
std::vector<float> initial_values(const Initial& initial, int64_t count, uint64_t seed,
                                  const std::string& name);

}  // namespace vkopple
