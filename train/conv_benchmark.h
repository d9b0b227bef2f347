#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace vkopple {

class Device;

/// A convolution of square images. Padding keeps the size at stride 1; a transposed one has stride 2 and
/// doubles the size.
struct TimedConvolution {
  bool transposed = false;
  int64_t kernel = 3;
  int64_t stride = 1;
  int64_t batch = 1;
  int64_t in_channels = 1;
  int64_t size = 1;
  int64_t out_channels = 1;
};

/// GFLOP/s of one convolution and its gradients, best of several runs, packing and reductions included.
struct ConvTiming {
  std::string label;
  TimedConvolution shape;
  double forward = 0;
  double data_gradient = 0;
  double weight_gradient = 0;
};

/// Times the shapes that the networks are made of.
std::vector<ConvTiming> benchmark_convolutions(const Device& device, int64_t batch, int repeats);

}  // namespace vkopple
