#include "graph/ops/smoothness_loss.h"

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors reference(const HostTensors& x) {
  const HostTensor& m = x[0];
  const Shape& s = m.shape;
  HostTensor y({1});
  const auto add_pair = [&](double a, double b) {
    y.values[0] += (a - b) * (a - b) / static_cast<double>(s[0]);
  };
  for (int64_t b = 0; b < s[0]; ++b)
    for (int64_t k = 0; k < s[1]; ++k)
      for (int64_t i = 0; i < s[2]; ++i)
        for (int64_t j = 0; j < s[3]; ++j) {
          if (i > 0) add_pair(m.at(b, k, i, j), m.at(b, k, i - 1, j));
          if (j > 0) add_pair(m.at(b, k, i, j), m.at(b, k, i, j - 1));
        }
  return {y};
}

}  // namespace

void check_smoothness_loss(CheckList& list) {
  for (const Shape& masks :
       {Shape{1, 1, 1, 1}, Shape{2, 4, 5, 7}, Shape{3, 2, 1, 9}, Shape{2, 3, 8, 1}, Shape{2, 2, 33, 37}})
    list.push_back({.label = masks.text(),
                    .op = std::make_shared<SmoothnessLoss>(),
                    .inputs = {row_major(masks)},
                    .reference = reference,
                    .ranges = {{0, 1}}});
}

}  // namespace vkopple
