#include "graph/ops/project.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {

void check_project(CheckList& list) {
  struct Case {
    Shape points;
    float fov;
    std::pair<double, double> range;
    double clear;  ///< least |y|: near y = 0 the slopes grow beyond what finite differences follow
  };
  for (const Case& c :
       {Case{{1, 1, 3, 1, 1}, 1.0F, {0.5, 3.0}, 0.2}, Case{{2, 3, 3, 5, 7}, 1.5707964F, {-3.0, 3.0}, 0.2},
        Case{{1, 4, 3, 8, 6}, 0.6F, {0.2, 4.0}, 0.2}, Case{{1, 2, 3, 17, 11}, 2.5F, {-4.0, 2.0}, 0.2},
        Case{{1, 1, 3, 7, 5}, 1.0F, {-0.01, 0.01}, 0.005}}) {  // 1e-5 counts in the last
    const auto reference = [fov = static_cast<double>(c.fov)](const HostTensors& x) {
      const Shape& shape = x[0].shape;
      const double f = static_cast<double>(shape[3]) / 2 / std::tan(fov / 2);
      HostTensor uvd(shape);
      for (int64_t b = 0; b < shape[0]; ++b)
        for (int64_t s = 0; s < shape[1]; ++s)
          for (int64_t row = 0; row < shape[3]; ++row)
            for (int64_t col = 0; col < shape[4]; ++col) {
              const double right = x[0].at(b, s, 0, row, col);
              const double forward = x[0].at(b, s, 1, row, col);
              const double up = x[0].at(b, s, 2, row, col);
              uvd.at(b, s, 0, row, col) = f * right / (std::abs(forward) + 1e-5);
              uvd.at(b, s, 1, row, col) = -f * up / (std::abs(forward) + 1e-5);
              uvd.at(b, s, 2, row, col) = std::copysign(std::hypot(right, forward, up), forward + 1e-5);
            }
      return HostTensors{uvd};
    };
    const auto off_the_lens = [clear = c.clear](HostTensors& x) {
      const Shape& shape = x[0].shape;
      for (int64_t b = 0; b < shape[0]; ++b)
        for (int64_t s = 0; s < shape[1]; ++s)
          for (int64_t row = 0; row < shape[3]; ++row)
            for (int64_t col = 0; col < shape[4]; ++col) {
              double& forward = x[0].at(b, s, 1, row, col);
              forward += std::copysign(clear, forward);
            }
    };
    list.push_back({.label = fmt::format("{} fov {}", c.points.text(), c.fov),
                    .op = std::make_shared<Project>(c.fov),
                    .inputs = {row_major(c.points)},
                    .reference = reference,
                    .ranges = {c.range},
                    .prepare = off_the_lens});
  }
}

}  // namespace vkopple
