#include "graph/ops/permute.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensor permuted(const HostTensor& x, const std::vector<size_t>& order) {
  const size_t rank = x.shape.rank();
  std::vector<int64_t> sizes;
  for (size_t axis : order) sizes.push_back(x.shape[axis]);
  HostTensor y{Shape(sizes)};
  std::vector<int64_t> index(rank, 0);  // of y
  for (double& value : y.values) {
    std::vector<int64_t> from(rank);
    for (size_t i = 0; i < rank; ++i) from[order[i]] = index[i];
    int64_t at = 0;
    for (size_t i = 0; i < rank; ++i) at = at * x.shape[i] + from[i];
    value = x.values[static_cast<size_t>(at)];
    for (size_t i = rank; i-- > 0;) {
      if (++index[i] < sizes[i]) break;
      index[i] = 0;
    }
  }
  return y;
}

}  // namespace

void check_permute(CheckList& list) {
  struct Case {
    Shape shape;
    std::vector<size_t> order;
  };
  const std::vector<Case> cases = {{{1}, {0}},
                                   {{7, 5}, {1, 0}},
                                   {{3, 4, 5}, {1, 0, 2}},
                                   {{2, 3, 4}, {2, 0, 1}},
                                   {{3, 1, 5}, {2, 1, 0}},
                                   {{2, 3, 4, 5}, {0, 2, 1, 3}},
                                   {{3, 4, 5}, {0, 1, 2}},
                                   {{2, 5, 3, 2}, {2, 3, 0, 1}},
                                   {{2, 3, 2, 3, 2, 3}, {5, 3, 1, 4, 2, 0}},
                                   {{1, 1, 1}, {2, 1, 0}}};
  for (const Case& c : cases)
    list.push_back(
        {.label = fmt::format("{} by ({})", c.shape.text(), fmt::join(c.order, ", ")),
         .op = std::make_shared<Permute>(c.order),
         .inputs = {row_major(c.shape)},
         .reference = [order = c.order](const HostTensors& x) { return HostTensors{permuted(x[0], order)}; }});
}

}  // namespace vkopple
