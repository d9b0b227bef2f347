#pragma once

#include <cstdint>

#include "graph/parallel/peers.h"

namespace vkopple {

struct Caps;

/// Of a device's `free` bytes, as this process found them, those that it may take: an equal share where other
/// processes of the run have the same device of the same machine. `peers` may be null.
uint64_t memory_share(uint64_t free, const Caps& caps, Peers* peers);

}  // namespace vkopple
