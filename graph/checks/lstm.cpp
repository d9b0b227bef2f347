#include "graph/ops/lstm.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

double sigmoid(double v) { return 1 / (1 + std::exp(-v)); }

/// One sample, step after step, as the formula has it.
void run_sample(const HostTensors& x, int64_t b, HostTensor& y) {
  const int64_t size = y.shape[2];
  const int64_t inputs = x[0].shape[1];
  std::vector<double> h(static_cast<size_t>(size), 0.0);
  std::vector<double> c = h;
  for (int64_t t = 0; t < y.shape[1]; ++t) {
    std::vector<double> a;
    for (int64_t row = 0; row < 4 * size; ++row) {
      double sum = x[3].at(row) + x[4].at(row);
      for (int64_t i = 0; i < inputs; ++i) sum += x[1].at(row, i) * x[0].at(b, i);
      for (int64_t i = 0; i < size; ++i) sum += x[2].at(row, i) * h[static_cast<size_t>(i)];
      a.push_back(sum);
    }
    for (int64_t j = 0; j < size; ++j) {
      const auto gate = [&](int64_t k) { return a[static_cast<size_t>(k * size + j)]; };
      double& cell = c[static_cast<size_t>(j)];
      cell = sigmoid(gate(1)) * cell + sigmoid(gate(0)) * std::tanh(gate(2));
      h[static_cast<size_t>(j)] = y.at(b, t, j) = sigmoid(gate(3)) * std::tanh(cell);
    }
  }
}

CheckCase lstm_case(int64_t batch, int64_t inputs, int64_t size, int64_t steps) {
  return {.label = fmt::format("batch {} inputs {} size {} steps {}", batch, inputs, size, steps),
          .op = std::make_shared<Lstm>(steps),
          .inputs = {row_major({batch, inputs}), row_major({4 * size, inputs}), row_major({4 * size, size}),
                     row_major({4 * size}), row_major({4 * size})},
          .reference = [=](const HostTensors& x) {
            HostTensor y(Shape{batch, steps, size});
            for (int64_t b = 0; b < batch; ++b) run_sample(x, b, y);
            return HostTensors{y};
          }};
}

}  // namespace

void check_lstm(CheckList& list) {
  list.push_back(lstm_case(1, 1, 1, 1));
  list.push_back(lstm_case(2, 5, 3, 3));
  list.push_back(lstm_case(3, 8, 4, 4));
  list.push_back(lstm_case(5, 12, 7, 2));
  list.push_back(lstm_case(2, 6, 17, 1));
}

}  // namespace vkopple
