#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace vkopple::test {

/// ‖got − wanted‖ / ‖wanted‖ in the L2 norm, of as many numbers.
inline double relative_error(const std::vector<float>& got, const std::vector<float>& wanted) {
  double difference = 0, norm = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    difference += std::pow(double{got.at(i)} - double{wanted[i]}, 2);
    norm += std::pow(double{wanted[i]}, 2);
  }
  return std::sqrt(difference / norm);
}

}  // namespace vkopple::test
