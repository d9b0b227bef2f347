#include "graph/ops/warp_share.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {

void check_warp_share(CheckList& list) {
  for (const bool warp : {true, false})
    for (const Shape& shape : {Shape{1, 1, 1, 1}, Shape{3, 1, 5, 7}, Shape{1, 1, 31, 33}}) {
      const auto reference = [warp](const HostTensors& x) {
        HostTensor share = x[0];
        for (double& v : share.values) v = warp ? 0.99 * std::clamp(v, 0.0, 1.0) : 0.0;
        return HostTensors{share};
      };
      const auto off_the_kinks = [](HostTensors& x) {
        for (double& v : x[0].values)
          if (std::abs(v - std::round(v)) < 0.01) v += 0.02;
      };
      list.push_back({.label = fmt::format("{} {}", shape.text(), warp ? "warp" : "no warp"),
                      .op = std::make_shared<WarpShare>(warp),
                      .inputs = {row_major(shape)},
                      .reference = reference,
                      .ranges = {{-0.5, 1.5}},
                      .prepare = off_the_kinks});
    }
}

}  // namespace vkopple
