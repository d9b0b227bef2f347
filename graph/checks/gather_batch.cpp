#include "graph/ops/gather_batch.h"

#include "graph/checks/check.h"

namespace vkopple {

/// Of one process; tests/graph/shared_batch_test.cpp has several.
void check_gather_batch(CheckList& list) {
  for (const Shape& shape : {Shape{1}, Shape{3, 2, 3}, Shape{4, 5}})
    list.push_back({.label = shape.text(),
                    .op = std::make_shared<GatherBatch>(nullptr),
                    .inputs = {row_major(shape)},
                    .reference = [](const HostTensors& x) { return x; }});
}

}  // namespace vkopple
