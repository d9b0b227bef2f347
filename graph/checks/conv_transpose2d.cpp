#include "graph/ops/conv_transpose2d.h"

#include <fmt/format.h>

#include "graph/checks/check.h"
#include "graph/conv/conv_product.h"

namespace vkopple {
namespace {

struct Case {
  Shape x;
  int64_t co, kernel;
  bool bias = true;
};

/// Adds what one input element gives to the outputs of one channel.
void scatter(HostTensor& y, const HostTensor& w, double value, int64_t n, int64_t ci, int64_t co, int64_t yi,
             int64_t xi) {
  const int64_t k = w.shape[2];
  const int64_t padding = k == 3 ? 1 : 0;
  for (int64_t ky = 0; ky < k; ++ky)
    for (int64_t kx = 0; kx < k; ++kx) {
      const int64_t yo = 2 * yi + ky - padding;
      const int64_t xo = 2 * xi + kx - padding;
      if (yo < 0 || yo >= y.shape[2] || xo < 0 || xo >= y.shape[3]) continue;
      y.at(n, co, yo, xo) += value * w.at(ci, co, ky, kx);
    }
}

HostTensors reference(const HostTensors& in) {
  const HostTensor& x = in[0];
  const HostTensor& w = in[1];
  HostTensor y({x.shape[0], w.shape[1], 2 * x.shape[2], 2 * x.shape[3]});
  for (int64_t n = 0; n < y.shape[0]; ++n)
    for (int64_t co = 0; co < y.shape[1]; ++co) {
      for (int64_t yo = 0; yo < y.shape[2]; ++yo)
        for (int64_t xo = 0; xo < y.shape[3]; ++xo) y.at(n, co, yo, xo) = in.size() > 2 ? in[2].at(co) : 0.0;
      for (int64_t ci = 0; ci < x.shape[1]; ++ci)
        for (int64_t yi = 0; yi < x.shape[2]; ++yi)
          for (int64_t xi = 0; xi < x.shape[3]; ++xi) scatter(y, w, x.at(n, ci, yi, xi), n, ci, co, yi, xi);
    }
  return {y};
}

void add(CheckList& list, const Case& c, const std::string& kernel) {
  std::vector<TensorSpec> inputs{channels4(c.x), row_major({c.x[1], c.co, c.kernel, c.kernel})};
  if (c.bias) inputs.push_back(row_major({c.co}));
  list.push_back({.label = fmt::format("{} to {} channels, {} x {} bias {} {}", c.x.text(), c.co, c.kernel,
                                       c.kernel, c.bias, kernel),
                  .op = std::make_shared<ConvTranspose2d>(ConvTranspose2dOptions{kernel}, c.bias),
                  .inputs = inputs,
                  .reference = reference,
                  .runs_on = [kernel](const Caps& caps) { return can_run_conv_kernel(kernel, caps); }});
}

}  // namespace

void check_conv_transpose2d(CheckList& list) {
  const std::vector<Case> cases{
      {{1, 1, 1, 1}, 1, 2},  {{1, 1, 1, 1}, 1, 3},        {{2, 3, 4, 3}, 5, 2}, {{2, 3, 4, 3}, 5, 3},
      {{1, 9, 3, 4}, 33, 3}, {{1, 6, 1, 7}, 2, 2, false}, {{3, 2, 5, 1}, 8, 3}, {{1, 8, 3, 3}, 8, 3, false},
  };
  for (const Case& c : cases)
    for (const std::string kernel : {"shuffle", "window", "uniform", "shared"}) add(list, c, kernel);
  add(list, {{1, 20, 3, 2}, 12, 3}, "");
}

}  // namespace vkopple
