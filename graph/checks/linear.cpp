#include "graph/ops/linear.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors linear_reference(const HostTensors& x) {
  const Shape& in = x[0].shape;
  const int64_t inputs = in.back(0);
  const int64_t outputs = x[1].shape[0];
  HostTensor y(in.with(in.rank() - 1, outputs));
  for (int64_t m = 0; m < in.elements() / inputs; ++m)
    for (int64_t o = 0; o < outputs; ++o) {
      double sum = x.size() > 2 ? x[2].at(o) : 0;
      for (int64_t i = 0; i < inputs; ++i)
        sum += x[0].values[static_cast<size_t>(m * inputs + i)] * x[1].at(o, i);
      y.values[static_cast<size_t>(m * outputs + o)] = sum;
    }
  return {y};
}

CheckCase linear_case(const Shape& in, int64_t outputs, bool bias) {
  CheckCase check{.label = fmt::format("{} to {}{}", in.text(), outputs, bias ? " with bias" : ""),
                  .op = std::make_shared<Linear>(bias),
                  .inputs = {row_major(in), row_major({outputs, in.back(0)})},
                  .reference = linear_reference};
  if (bias) check.inputs.push_back(row_major({outputs}));
  return check;
}

}  // namespace

void check_linear(CheckList& list) {
  list.push_back(linear_case({1}, 1, true));
  list.push_back(linear_case({3, 2, 7}, 5, true));    // no vectors
  list.push_back(linear_case({4, 7}, 64, true));      // vectors of outputs only
  list.push_back(linear_case({5, 16}, 11, false));    // vectors of inputs only
  list.push_back(linear_case({2, 3, 32}, 36, true));  // both, two runs of rows
  list.push_back(linear_case({3, 259}, 3, true));     // longer than one run of a sum, along each axis
  list.push_back(linear_case({2, 516}, 2, true));
  list.push_back(linear_case({2, 3}, 261, true));
  list.push_back(linear_case({2, 4}, 260, false));
  list.push_back(linear_case({258, 3}, 2, true));
  list.push_back(linear_case({37, 13}, 70, true));  // beyond one tile of shared memory
  list.push_back(linear_case({40, 12}, 136, true));
}

}  // namespace vkopple
