#include "graph/ops/decode_location.h"

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

double sigmoid(double x) { return 1 / (1 + std::exp(-x)); }

HostTensor decoded(const HostTensor& raw, double fov, double max_depth, double max_height) {
  HostTensor location({raw.shape[0], raw.shape[1], 3});
  for (int64_t b = 0; b < raw.shape[0]; ++b)
    for (int64_t k = 0; k < raw.shape[1]; ++k) {
      const double theta = 0.6 * fov * (2 * sigmoid(raw.at(b, k, 0)) - 1);
      const double rho = max_depth * sigmoid(raw.at(b, k, 1));
      location.at(b, k, 0) = rho * std::sin(theta);
      location.at(b, k, 1) = rho * std::cos(theta);
      location.at(b, k, 2) = max_height * (2 * sigmoid(raw.at(b, k, 2)) - 1);
    }
  return location;
}

}  // namespace

void check_decode_location(CheckList& list) {
  for (const Shape& shape : {Shape{1, 1, 3}, Shape{5, 3, 187}, Shape{2, 8, 4}})
    for (const LocationRange& range : {LocationRange{1.5707964F, 7.2F, 5}, LocationRange{2.5F, 3, 1}})
      list.push_back({.label = shape.text(),
                      .op = std::make_shared<DecodeLocation>(range),
                      .inputs = {row_major(shape)},
                      .reference =
                          [range](const HostTensors& x) {
                            return HostTensors{decoded(x[0], static_cast<double>(range.fov),
                                                       static_cast<double>(range.max_depth),
                                                       static_cast<double>(range.max_height))};
                          },
                      .ranges = {{-6, 6}}});
}

}  // namespace vkopple
