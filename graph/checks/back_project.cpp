#include "graph/ops/back_project.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {

void check_back_project(CheckList& list) {
  struct Case {
    Shape depth;
    float fov;
  };
  for (const Case& c : {Case{{1, 1, 1, 1}, 1.0F}, Case{{3, 1, 5, 7}, 1.5707964F}, Case{{2, 1, 8, 6}, 0.6F},
                        Case{{1, 1, 17, 31}, 2.5F}}) {
    const auto reference = [fov = static_cast<double>(c.fov)](const HostTensors& x) {
      const Shape& shape = x[0].shape;
      const double f = static_cast<double>(shape[2]) / 2 / std::tan(fov / 2);
      HostTensor points(shape.with(1, 3));
      for (int64_t b = 0; b < shape[0]; ++b)
        for (int64_t row = 0; row < shape[2]; ++row)
          for (int64_t col = 0; col < shape[3]; ++col) {
            const double i = (static_cast<double>(col) - static_cast<double>(shape[3] - 1) / 2) / f;
            const double j = (static_cast<double>(row) - static_cast<double>(shape[2] - 1) / 2) / f;
            const double planar = x[0].at(b, 0, row, col) / std::sqrt(1 + i * i + j * j);
            points.at(b, 0, row, col) = planar * i;
            points.at(b, 1, row, col) = planar;
            points.at(b, 2, row, col) = -planar * j;
          }
      return HostTensors{points};
    };
    list.push_back({.label = fmt::format("{} fov {}", c.depth.text(), c.fov),
                    .op = std::make_shared<BackProject>(c.fov),
                    .inputs = {row_major(c.depth)},
                    .reference = reference,
                    .ranges = {{0.1, 7.0}}});
  }
}

}  // namespace vkopple
