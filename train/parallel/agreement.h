#pragma once

#include <string_view>

#include "graph/parallel/peers.h"

namespace vkopple {

// What the processes of a run settle with each other beside gradients. `peers` may be null: everything is
// settled.

/// Throws Error where `text` is not the same in all processes; `what` says what it is.
void require_same(Peers* peers, std::string_view text, std::string_view what);

/// Whether it is so in any process.
bool any(Peers* peers, bool here);

}  // namespace vkopple
