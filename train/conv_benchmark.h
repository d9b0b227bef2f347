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

/// How one of a convolution's products ran, packing and reductions included.
struct ProductTiming {
  double gflops = 0;  ///< GFLOP/s, best of several runs; the flops are the definition's, whatever the algorithm
  std::string algorithm;  ///< as name_of(ConvAlgorithm)
};

struct ConvTiming {
  std::string label;
  TimedConvolution shape;
  ProductTiming forward, data_gradient, weight_gradient;
};

/// Times the shapes that the networks are made of, as the device would run them.
std::vector<ConvTiming> benchmark_convolutions(const Device& device, int64_t batch, int repeats);

}  // namespace vkopple
