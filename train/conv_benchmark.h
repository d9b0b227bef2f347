#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace vkopple {

class Device;

/// GFLOP/s of one convolution and its gradients, best of several runs, packing and reductions included.
struct ConvTiming {
  std::string label;
  double forward = 0;
  double data_gradient = 0;
  double weight_gradient = 0;
};

/// Times the shapes that the networks are made of.
std::vector<ConvTiming> benchmark_convolutions(const Device& device, int64_t batch, int repeats);

}  // namespace vkopple
