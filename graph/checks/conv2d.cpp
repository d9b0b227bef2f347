#include "graph/ops/conv2d.h"

#include <fmt/format.h>

#include "graph/checks/check.h"
#include "graph/conv/convolution.h"

namespace vkopple {
namespace {

struct Case {
  Shape x;
  int64_t co, kernel;
  Conv2dOptions options;
  bool bias = true;
};

int64_t size_after(int64_t size, int64_t kernel, const Conv2dOptions& o) {
  return (size + 2 * o.padding - o.dilation * (kernel - 1) - 1) / o.stride + 1;
}

/// One output of one image and channel, straight from the definition.
double output_at(const HostTensor& x, const HostTensor& w, int64_t n, int64_t co, int64_t yo, int64_t xo,
                 const Conv2dOptions& o) {
  double sum = 0;
  for (int64_t ci = 0; ci < w.shape[1]; ++ci)
    for (int64_t ky = 0; ky < w.shape[2]; ++ky)
      for (int64_t kx = 0; kx < w.shape[2]; ++kx) {
        const int64_t yi = yo * o.stride + ky * o.dilation - o.padding;
        const int64_t xi = xo * o.stride + kx * o.dilation - o.padding;
        if (yi < 0 || yi >= x.shape[2] || xi < 0 || xi >= x.shape[3]) continue;
        sum += x.at(n, ci, yi, xi) * w.at(co, ci, ky, kx);
      }
  return sum;
}

HostTensors reference(const HostTensors& in, const Conv2dOptions& o) {
  const HostTensor& x = in[0];
  const HostTensor& w = in[1];
  const int64_t k = w.shape[2];
  HostTensor y({x.shape[0], w.shape[0], size_after(x.shape[2], k, o), size_after(x.shape[3], k, o)});
  for (int64_t n = 0; n < y.shape[0]; ++n)
    for (int64_t co = 0; co < y.shape[1]; ++co)
      for (int64_t yo = 0; yo < y.shape[2]; ++yo)
        for (int64_t xo = 0; xo < y.shape[3]; ++xo)
          y.at(n, co, yo, xo) = output_at(x, w, n, co, yo, xo, o) + (in.size() > 2 ? in[2].at(co) : 0.0);
  return {y};
}

void add(CheckList& list, const Case& c) {
  std::vector<TensorSpec> inputs{channels4(c.x), row_major({c.co, c.x[1], c.kernel, c.kernel})};
  if (c.bias) inputs.push_back(row_major({c.co}));
  list.push_back({.label = fmt::format("{} to {} channels, {} x {} stride {} padding {} dilation {} bias {} {}",
                                       c.x.text(), c.co, c.kernel, c.kernel, c.options.stride,
                                       c.options.padding, c.options.dilation, c.bias, c.options.kernel),
                  .op = std::make_shared<Conv2d>(c.options, c.bias),
                  .inputs = inputs,
                  .reference = [o = c.options](const HostTensors& x) { return reference(x, o); },
                  .runs_on =
                      [op = std::make_shared<Conv2d>(c.options, c.bias), c](const Caps& caps) {
                        return can_run_convolution(c.options.kernel,
                                                   op->shape_of(c.x, {c.co, c.x[1], c.kernel, c.kernel}), caps);
                      }});
}

}  // namespace

void check_conv2d(CheckList& list) {
  const std::vector<Case> cases{
      {{1, 1, 1, 1}, 1, 1, {}},
      {{3, 5, 1, 1}, 7, 3, {.padding = 1}},
      {{2, 3, 5, 7}, 5, 3, {.padding = 1}},
      {{1, 8, 9, 8}, 33, 3, {.padding = 1}, false},
      {{2, 2, 7, 5}, 3, 3, {.stride = 2, .padding = 1}},
      {{2, 6, 8, 6}, 9, 3, {.stride = 2, .padding = 1}},
      {{1, 3, 6, 5}, 2, 1, {.stride = 2}},
      {{1, 4, 5, 6}, 3, 2, {.stride = 2}},
      {{1, 3, 13, 4}, 4, 2, {.padding = 1}},
      {{1, 2, 9, 7}, 5, 3, {.padding = 2, .dilation = 2}},
      {{1, 3, 5, 5}, 4, 3, {.padding = 12, .dilation = 12}, false},
      {{1, 2, 9, 8}, 3, 3, {.stride = 2, .padding = 2, .dilation = 2}},
      {{1, 2, 9, 11}, 3, 3, {.stride = 2, .padding = 3, .dilation = 3}},
      {{1, 2, 11, 11}, 1, 3, {}},
      // Whole rows of a subgroup's pixels, in several images and beyond the last channel.
      {{3, 8, 4, 4}, 20, 1, {}},
      {{3, 12, 8, 8}, 12, 3, {.padding = 1}},
  };
  for (const Case& c : cases)
    for (const std::string kernel : {"shuffle", "window", "uniform", "shared"}) {
      if (kernel == "window" && c.options.dilation > 1) continue;
      Case forced = c;
      forced.options.kernel = kernel;
      add(list, forced);
    }
  add(list, {{1, 20, 3, 3}, 40, 3, {.padding = 1}});
  const std::vector<Case> winograd{
      {{1, 1, 1, 1}, 1, 3, {.padding = 1}},        {{3, 5, 1, 2}, 7, 3, {.padding = 1}},
      {{2, 3, 5, 7}, 5, 3, {.padding = 1}},        {{1, 8, 9, 8}, 33, 3, {.padding = 1}, false},
      {{1, 20, 4, 3}, 40, 3, {.padding = 1}},      {{1, 2, 11, 6}, 1, 3, {}},
      {{1, 3, 4, 5}, 4, 3, {.padding = 2}, false}, {{1, 4, 3, 4}, 6, 3, {.padding = 3}},
  };
  for (const Case& c : winograd)
    for (const std::string kernel : {"winograd2", "winograd4"}) {
      Case forced = c;
      forced.options.kernel = kernel;
      add(list, forced);
    }
}

}  // namespace vkopple
