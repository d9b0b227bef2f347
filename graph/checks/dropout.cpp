#include "graph/ops/dropout.h"

#include <fmt/format.h>

#include "graph/checks/check_random.h"

namespace vkopple {
namespace {

CheckCase dropout_case(const TensorSpec& spec, float rate, uint32_t stream) {
  return {.label = fmt::format("{} rate {}", spec.shape.text(), rate),
          .op = std::make_shared<Dropout>(rate, stream),
          .inputs = {spec, unsigned_ints({2})},
          .reference =
              [=](const HostTensors& x) {
                HostTensor y = x[0];
                apply_dropout(y, spec, x[1], stream, rate);
                return HostTensors{y};
              },
          .prepare = [](HostTensors& x) { set_random(x[1], 1234567, 42); }};
}

}  // namespace

void check_dropout(CheckList& list) {
  list.push_back(dropout_case(row_major({1}), 0.5F, 0));
  list.push_back(dropout_case(row_major({4}), 0.0F, 0));
  list.push_back(dropout_case(row_major({3, 5, 7}), 0.3F, 7));
  list.push_back(dropout_case(row_major({2051}), 0.05F, 1));
  list.push_back(dropout_case(row_major({4, 16, 33}), 0.5F, 2));
  list.push_back(dropout_case(channels4({2, 3, 5, 7}), 0.5F, 3));
  list.push_back(dropout_case(channels4({1, 17, 9, 8}), 0.1F, 4));
}

}  // namespace vkopple
