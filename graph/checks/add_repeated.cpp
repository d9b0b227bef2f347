#include "graph/ops/add_repeated.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {

void check_add_repeated(CheckList& list) {
  struct Case {
    int64_t frames, slots, inner;
    Shape sample;
  };
  for (const Case& c : {Case{1, 1, 1, {1, 1, 1, 1}}, Case{2, 3, 2, {1, 3, 5, 3}}, Case{1, 4, 3, {1, 8, 2, 2}},
                        Case{3, 2, 1, {1, 5, 3, 1}}}) {
    const auto reference = [c](const HostTensors& x) {
      HostTensor y = x[0];
      const int64_t size = c.sample.elements();
      for (int64_t f = 0; f < c.frames; ++f)
        for (int64_t k = 0; k < c.slots; ++k)
          for (int64_t i = 0; i < c.inner; ++i)
            for (int64_t e = 0; e < size; ++e)
              y.values[static_cast<size_t>(((f * c.slots + k) * c.inner + i) * size + e)] +=
                  x[1].values[static_cast<size_t>((f * c.inner + i) * size + e)];
      return HostTensors{y};
    };
    list.push_back({.label = fmt::format("{} x {} x {} of {}", c.frames, c.slots, c.inner, c.sample.text()),
                    .op = std::make_shared<AddRepeated>(c.inner),
                    .inputs = {channels4(c.sample.with(0, c.frames * c.slots * c.inner)),
                               channels4(c.sample.with(0, c.frames * c.inner))},
                    .reference = reference});
  }
}

}  // namespace vkopple
