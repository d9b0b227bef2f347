#pragma once

#include <span>

#include "graph/norm/normalise.h"
#include "graph/parallel/peers.h"

namespace vkopple {

// Batch normalisation over the batches of several processes: between the two stages of its reductions the host
// puts what all have found in place of what one has (shaders/norm says what the partials are). Each joins its
// own strips first, so that no more than a few numbers a channel pass between processes.

/// How the second stage of forward is to count strips whose content share_statistics() has made.
NormStrips shared_strips(const NormStrips& strips, int processes);

/// `partials` of norm_statistics, (groups, blocks, strips) × {mean, squares about it, what the mean rounds off}
/// of 4 channels: puts strips in their place which, counted by shared_strips(), have mean and squares of all
/// processes' values.
void share_statistics(Peers& peers, const NormStrips& strips, std::span<float> partials);

/// `partials` of norm_reduce, (groups, blocks, strips) × {sum of dy', sum of dy' (leaky(x) − mean)} of 4
/// channels: puts strips in their place which, counted as they were, have the means of all processes' sums.
void share_sums(Peers& peers, const NormStrips& strips, std::span<float> partials);

}  // namespace vkopple
