#pragma once

#include <cstdint>
#include <vector>

#include "models/opple.h"
#include "train/data/batch_part.h"
#include "train/data/triplets.h"

namespace vkopple {

// What chance decides in a step of training. Each is a function of seed and step alone, so that a run that was
// stopped goes on as it would have.

/// For every triplet of a batch whether it is shown backwards in time.
std::vector<bool> reversed_triplets(uint64_t seed, uint64_t step, int batch, double probability);
/// A permutation of 0 ... batch - 1, which pairs scenes for the collapse term. Of a portion of the batch, whose
/// scenes are counted from 0 then: they follow each other as in the permutation of the whole.
std::vector<uint32_t> scene_permutation(uint64_t seed, uint64_t step, int batch, BatchPart portion = {});

/// A batch as the model takes it.
Triplets model_triplets(const TripletBatch& batch, std::vector<uint32_t> permutation);

/// What step `step` of training shows in a batch of `batch` to a model that looks at the images from
/// `first_frame` on: of the batch's portions one, which is a step of the source, and of several processes to
/// the one whose `part` of portions the source gives. The permutation is of the whole portion.
Triplets training_triplets(TripletSource& source, uint64_t seed, uint64_t step, int batch,
                           double reverse_probability, int first_frame = 0, BatchPart part = {},
                           BatchPart portion = {});

}  // namespace vkopple
