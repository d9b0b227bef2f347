#include "graph/ops/splat.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

/// Scatters every point into a grid with a ring of one pixel, which is then thrown away.
HostTensors splatted(const HostTensors& x, double beta) {
  const HostTensor& image = x[0];
  const HostTensor& uvd = x[1];
  const Shape& s = x[2].shape;
  const int64_t height = s[2];
  const int64_t width = s[3];
  HostTensor numerator({s[0], 4, height + 2, width + 2});
  HostTensor divisor({s[0], height + 2, width + 2});
  HostTensor all({s[0], height + 2, width + 2});
  for (int64_t b = 0; b < s[0]; ++b)
    for (int64_t k = 0; k < s[1]; ++k)
      for (int64_t i = 0; i < height; ++i)
        for (int64_t j = 0; j < width; ++j) {
          const double column = uvd.at(b, k, 0, i, j) + static_cast<double>(width + 1) / 2;
          const double row = uvd.at(b, k, 1, i, j) + static_cast<double>(height + 1) / 2;
          const double d = uvd.at(b, k, 2, i, j);
          if (!(d > 1e-5)) continue;
          for (int64_t tap = 0; tap < 4; ++tap) {
            const double c = std::floor(column) + static_cast<double>(tap % 2);
            const double r = std::floor(row) + static_cast<double>(tap / 2);
            const double a = (1 - std::abs(column - c)) * (1 - std::abs(row - r)) * x[2].at(b, k, i, j);
            const auto tc = static_cast<int64_t>(std::clamp(c, 0.0, static_cast<double>(width + 1)));
            const auto tr = static_cast<int64_t>(std::clamp(r, 0.0, static_cast<double>(height + 1)));
            all.at(b, tr, tc) += a;
            divisor.at(b, tr, tc) += a * std::exp(-beta * d);
            for (int64_t f = 0; f < 4; ++f)
              numerator.at(b, f, tr, tc) += a * std::exp(-beta * d) * (f < 3 ? image.at(b, f, i, j) : d);
          }
        }
  HostTensors out{HostTensor(s.with(1, 3)), HostTensor(s.with(1, 1)), HostTensor(s.with(1, 1))};
  for (int64_t b = 0; b < s[0]; ++b)
    for (int64_t i = 0; i < height; ++i)
      for (int64_t j = 0; j < width; ++j) {
        for (int64_t f = 0; f < 4; ++f)
          out[f < 3 ? 0 : 1].at(b, f % 3, i, j) =
              numerator.at(b, f, i + 1, j + 1) / (divisor.at(b, i + 1, j + 1) + 1e-22);
        out[2].at(b, 0, i, j) = all.at(b, i + 1, j + 1);
      }
  return out;
}

/// Moves a coordinate away from whole pixels, where finite differences straddle the floor.
double off_the_grid(double at, int64_t size) {
  const double shift = static_cast<double>(size + 1) / 2;
  const double whole = std::floor(at + shift);
  return whole + 0.02 + 0.96 * (at + shift - whole) - shift;
}

/// Turns draws from (-1, 1) into places on the image, the ring and up to two pixels beyond, and distances
/// before and behind the camera. `spread` 0 puts every point into one cell.
void spread_points(HostTensor& uvd, double spread) {
  const Shape& s = uvd.shape;
  for (int64_t b = 0; b < s[0]; ++b)
    for (int64_t k = 0; k < s[1]; ++k)
      for (int64_t i = 0; i < s[3]; ++i)
        for (int64_t j = 0; j < s[4]; ++j) {
          for (int64_t axis = 0; axis < 2; ++axis) {
            double& at = uvd.at(b, k, axis, i, j);
            const int64_t size = s[4 - static_cast<size_t>(axis)];
            const double half = static_cast<double>(size) / 2 + 2;
            at = off_the_grid(spread > 0 ? at * half * spread : 0.2 + 0.1 * at, size);
          }
          double& d = uvd.at(b, k, 2, i, j);
          d = 1 + 2 * d;
          if (std::abs(d) < 0.05) d += std::copysign(0.05, d);
        }
}

}  // namespace

void check_splat(CheckList& list) {
  struct Case {
    Shape weight;
    float beta;
    double spread;
  };
  for (const Case& c :
       {Case{{1, 1, 1, 1}, 1.0F, 0.2}, Case{{3, 4, 5, 7}, 1.0F, 1.0}, Case{{2, 1, 9, 8}, 0.3F, 1.0},
        Case{{1, 3, 13, 11}, 2.0F, 0.3}, Case{{2, 2, 4, 17}, 0.0F, 1.0}, Case{{2, 3, 8, 7}, 1.0F, 0.0},
        Case{{1, 2, 29, 23}, 1.0F, 1.0}})
    list.push_back(
        {.label = fmt::format("{} beta {} spread {}", c.weight.text(), c.beta, c.spread),
         .op = std::make_shared<Splat>(c.beta),
         .inputs = {row_major(c.weight.with(1, 3)),
                    row_major({c.weight[0], c.weight[1], 3, c.weight[2], c.weight[3]}), row_major(c.weight)},
         .reference = [beta = static_cast<double>(c.beta)](const HostTensors& x) { return splatted(x, beta); },
         .ranges = {{0.0, 1.0}, {-1.0, 1.0}, {0.05, 1.0}},
         .prepare = [spread = c.spread](HostTensors& x) { spread_points(x[1], spread); }});
}

}  // namespace vkopple
