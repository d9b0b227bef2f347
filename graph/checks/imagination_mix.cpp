#include "graph/ops/imagination_mix.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors mixed(const HostTensor& y, int64_t slots, double max_depth) {
  const Shape& s = y.shape;
  const int64_t images = s[0] / slots;
  HostTensors out{HostTensor({images, 3, s[2], s[3]}), HostTensor({images, 1, s[2], s[3]})};
  const auto sigmoid = [](double v) { return 1 / (1 + std::exp(-v)); };
  for (int64_t b = 0; b < images; ++b)
    for (int64_t i = 0; i < s[2]; ++i)
      for (int64_t j = 0; j < s[3]; ++j) {
        double sum = 0;
        for (int64_t k = 0; k < slots; ++k) sum += std::exp(y.at(b * slots + k, 4, i, j));
        for (int64_t k = 0; k < slots; ++k) {
          const double weight = std::exp(y.at(b * slots + k, 4, i, j)) / sum;
          for (int64_t c = 0; c < 3; ++c)
            out[0].at(b, c, i, j) += weight * sigmoid(y.at(b * slots + k, c, i, j));
          out[1].at(b, 0, i, j) += weight * (max_depth * sigmoid(y.at(b * slots + k, 3, i, j)) + 1e-5);
        }
      }
  return out;
}

}  // namespace

void check_imagination_mix(CheckList& list) {
  struct Case {
    Shape y;
    int64_t slots;
    float max_depth;
    double bound;
  };
  for (const Case& c :
       {Case{{1, 5, 1, 1}, 1, 7.2F, 3}, Case{{12, 5, 5, 7}, 4, 7.2F, 3}, Case{{6, 5, 9, 8}, 2, 1.0F, 3},
        Case{{3, 5, 13, 5}, 3, 0.004F, 1}})  // a depth beside which 1e-5 counts
    list.push_back(
        {.label = fmt::format("{} {} slots", c.y.text(), c.slots),
         .op = std::make_shared<ImaginationMix>(c.slots, c.max_depth),
         .inputs = {channels4(c.y)},
         .reference =
             [c](const HostTensors& x) { return mixed(x[0], c.slots, static_cast<double>(c.max_depth)); },
         .ranges = {{-c.bound, c.bound}}});
}

}  // namespace vkopple
