#include "graph/ops/match.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors matched(const HostTensor& a, const HostTensor& b, int64_t identity) {
  const int64_t slots = a.shape[1];
  HostTensor log_w({a.shape[0], slots, slots});
  HostTensor q({a.shape[0], slots});
  for (int64_t n = 0; n < a.shape[0]; ++n)
    for (int64_t k = 0; k < slots; ++k) {
      const auto weight = [&](int64_t l) {
        double distance2 = 0;
        for (int64_t c = 0; c < identity; ++c)
          distance2 += std::pow(b.at(n, k, c) - (l < slots ? a.at(n, l, c) : 0.0), 2);
        return std::exp(-distance2);
      };
      double objects = 0;
      for (int64_t l = 0; l < slots; ++l) objects += weight(l);
      for (int64_t l = 0; l < slots; ++l) log_w.at(n, k, l) = std::log(weight(l) / objects);
      q.at(n, k) = objects / (objects + weight(slots));
    }
  return {log_w, q};
}

}  // namespace

void check_match(CheckList& list) {
  struct Case {
    Shape codes;
    int64_t identity;
    double range;
  };
  for (const Case& c : {Case{{1, 1, 1}, 1, 1}, Case{{4, 3, 64}, 10, 1}, Case{{2, 8, 11}, 11, 0.5},
                        Case{{3, 2, 5}, 4, 4}, Case{{20, 3, 7}, 3, 2}})
    list.push_back(
        {.label = fmt::format("{}, identity {}, to {}", c.codes.text(), c.identity, c.range),
         .op = std::make_shared<Match>(c.identity),
         .inputs = {row_major(c.codes), row_major(c.codes)},
         .reference = [identity = c.identity](const HostTensors& x) { return matched(x[0], x[1], identity); },
         .ranges = {{-c.range, c.range}, {-c.range, c.range}}});
}

}  // namespace vkopple
