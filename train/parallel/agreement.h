#pragma once

#include <string_view>

#include "graph/parallel/peers.h"

namespace vkopple {

// What the processes of a run settle with each other beside gradients. `peers` may be null: everything is
// settled.

/// Throws Error where `text` is not the same in all processes; `what` says what it is.
void require_same(Peers* peers, std::string_view text, std::string_view what);

/// How many of the processes have the same `text`, this one included.
int count_same(Peers* peers, std::string_view text);

/// The largest of the processes' numbers.
float largest(Peers* peers, float here);

/// Whether it is so in any process.
bool any(Peers* peers, bool here);

}  // namespace vkopple
