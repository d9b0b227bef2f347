#include "graph/ops/align.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors aligned_objects(const HostTensor& log_w, const HostTensor& location, const HostTensor& log_pose) {
  HostTensor place(location.shape);
  HostTensor pose(log_pose.shape);
  const int64_t slots = log_w.shape[1];
  const int64_t bins = log_pose.shape[2];
  for (int64_t n = 0; n < log_w.shape[0]; ++n)
    for (int64_t k = 0; k < slots; ++k) {
      double total = 0;
      for (int64_t l = 0; l < slots; ++l) {
        const double w = std::exp(log_w.at(n, k, l));
        for (int64_t i = 0; i < 3; ++i) place.at(n, k, i) += w * location.at(n, l, i);
        for (int64_t m = 0; m < bins; ++m) {
          pose.at(n, k, m) += w * std::exp(log_pose.at(n, l, m));
          total += w * std::exp(log_pose.at(n, l, m));
        }
      }
      for (int64_t m = 0; m < bins; ++m) pose.at(n, k, m) = std::log(pose.at(n, k, m) / total);
    }
  return {place, pose};
}

}  // namespace

void check_align(CheckList& list) {
  struct Case {
    int64_t batch;
    int64_t slots;
    int64_t bins;
  };
  for (const Case& c : {Case{1, 1, 1}, Case{2, 3, 120}, Case{3, 2, 7}, Case{1, 8, 13}, Case{1, 2, 361}})
    list.push_back({.label = fmt::format("batch {}, {} slots, {} bins", c.batch, c.slots, c.bins),
                    .op = std::make_shared<Align>(),
                    .inputs = {row_major({c.batch, c.slots, c.slots}), row_major({c.batch, c.slots, 3}),
                               row_major({c.batch, c.slots, c.bins})},
                    .reference = [](const HostTensors& x) { return aligned_objects(x[0], x[1], x[2]); },
                    .ranges = {{-6, 0}, {-5, 5}, {-12, 0}}});
}

}  // namespace vkopple
