#include "graph/ops/batch_norm.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check_random.h"

namespace vkopple {
namespace {

struct Moments {
  double mean = 0;
  double variance = 0;  ///< biased
};

/// Of channel c of samples begin … end − 1.
Moments moments(const HostTensor& x, int64_t c, int64_t begin, int64_t end) {
  const Shape& s = x.shape;
  Moments m;
  const auto count = static_cast<double>((end - begin) * s[2] * s[3]);
  const auto over_all = [&](auto visit) {
    for (int64_t n = begin; n < end; ++n)
      for (int64_t h = 0; h < s[2]; ++h)
        for (int64_t w = 0; w < s[3]; ++w) visit(x.at(n, c, h, w));
  };
  over_all([&](double v) { m.mean += v / count; });
  over_all([&](double v) { m.variance += (v - m.mean) * (v - m.mean) / count; });
  return m;
}

HostTensors batch_norm_reference(const HostTensors& x, const TensorSpec& spec, const BatchNormOptions& o) {
  HostTensor v = x[0];
  for (double& e : v.values) e = e > 0 ? e : static_cast<double>(o.slope) * e;
  HostTensor y(v.shape);
  HostTensor mean = x[3];
  HostTensor var = x[4];
  const Shape& s = v.shape;
  const int64_t run = s[0] / o.groups;
  const auto count = static_cast<double>(run * s[2] * s[3]);
  for (int64_t g = 0; g < o.groups; ++g)
    for (int64_t c = 0; c < s[1]; ++c) {
      Moments m{mean.at(c), var.at(c)};
      if (o.training) {
        m = moments(v, c, g * run, (g + 1) * run);
        const double unbiased = count > 1 ? m.variance * count / (count - 1) : m.variance;
        mean.at(c) += static_cast<double>(o.momentum) * (m.mean - mean.at(c));
        var.at(c) += static_cast<double>(o.momentum) * (unbiased - var.at(c));
      }
      for (int64_t n = g * run; n < (g + 1) * run; ++n)
        for (int64_t h = 0; h < s[2]; ++h)
          for (int64_t w = 0; w < s[3]; ++w)
            y.at(n, c, h, w) =
                (v.at(n, c, h, w) - m.mean) / std::sqrt(m.variance + static_cast<double>(o.eps)) * x[1].at(c) +
                x[2].at(c);
    }
  if (o.training && o.dropout > 0) apply_dropout(y, spec, x[5], o.stream, o.dropout);
  if (!o.training) return {y};
  return {y, mean, var};
}

CheckCase batch_norm_case(const Shape& shape, const BatchNormOptions& o, double offset = 0) {
  const TensorSpec spec = channels4(shape);
  const TensorSpec channel = row_major({shape[1]});
  CheckCase check{.label = fmt::format("{} groups {} training {} slope {} dropout {} offset {}", shape.text(),
                                       o.groups, o.training, o.slope, o.dropout, offset),
                  .op = std::make_shared<BatchNorm>(o),
                  .inputs = {spec, channel, channel, channel, channel},
                  .reference = [=](const HostTensors& x) { return batch_norm_reference(x, spec, o); },
                  .ranges = {{-1, 1}, {0.5, 1.5}, {-1, 1}, {-1, 1}, {0.2, 2}},
                  .prepare =
                      [=](HostTensors& x) {
                        for (double& v : x[0].values) v += std::copysign(0.01, v) + offset;
                        if (x.size() > 5) set_random(x[5], 77, 3);
                      }};
  if (o.training && o.dropout > 0) check.inputs.push_back(unsigned_ints({2}));
  return check;
}

}  // namespace

void check_batch_norm(CheckList& list) {
  list.push_back(batch_norm_case({2, 1, 1, 2}, {.eps = 0.01F}));
  list.push_back(batch_norm_case({1, 3, 1, 1}, {.eps = 0.01F}));
  list.push_back(batch_norm_case({4, 5, 1, 1}, {.eps = 1e-3F, .slope = 0.1F}));
  list.push_back(batch_norm_case({12, 6, 1, 1}, {.eps = 0.01F, .groups = 3, .slope = 0.1F}));
  list.push_back(batch_norm_case({2, 7, 3, 5}, {.eps = 1e-5F, .momentum = 0.3F}));
  list.push_back(batch_norm_case({6, 4, 7, 3}, {.groups = 2, .slope = 0.1F, .dropout = 0.3F, .stream = 9}));
  list.push_back(batch_norm_case({1, 9, 16, 16}, {.eps = 1e-6F, .slope = 0.1F, .dropout = 0.05F}));
  list.push_back(batch_norm_case({3, 2, 37, 31}, {.groups = 3, .slope = 0.1F}));
  list.push_back(batch_norm_case({4, 3, 33, 32}, {.groups = 2, .slope = 0.1F, .dropout = 0.1F}));
  list.push_back(batch_norm_case({3, 5, 6, 7}, {.slope = 0.1F, .dropout = 0.2F}));
  // A mean far from zero: a variance taken as E[x²] − E[x]² loses all its digits here.
  list.push_back(batch_norm_case({2, 3, 17, 19}, {.groups = 1}, 300));
  list.push_back(
      batch_norm_case({6, 5, 4, 3}, {.groups = 3, .training = false, .slope = 0.1F, .dropout = 0.5F}));
}

}  // namespace vkopple
