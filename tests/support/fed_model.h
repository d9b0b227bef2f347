#pragma once

#include "graph/executor.h"
#include "models/initialise.h"
#include "models/opple.h"

namespace vkopple::test {

/// Writes all that a pass of the model reads: drawn weights, constants, dropout's counters and a batch.
inline void feed_drawn(Executor& executor, const Opple& model, const Triplets& triplets) {
  for (const InitialTensor& t : model.tensors())
    executor.write(t.value, initial_values(t.initial, t.value.shape().elements(), 3, t.name));
  model.feed_constants(executor);
  model.feed_random(executor, 1, 1);
  model.feed(executor, triplets);
}

}  // namespace vkopple::test
