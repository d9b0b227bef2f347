#pragma once

#include "models/initialise.h"
#include "models/model_config.h"

namespace vkopple {

/// How the slots' LSTM and its head start where some hidden units count the steps (`slot_counters`,
/// docs/model.md §2).
///
/// Started as published, the steps of an LSTM that reads one input again and again say nearly the same: slots
/// have nearly the same identity code, matching takes each for the mean of all, and the losses hold them
/// together. Here hidden unit 0 is on from the first step, unit 1 from the second and so on up to unit
/// `slot_counters`. Each of the latter sets a component of the identity code to +1.67 where it is on and to
/// −1.67 where it is off. So slots differ from each other and from the background from the beginning, whatever
/// the image, and are matched by their number until training finds something better. Identity codes depend on
/// nothing else at first. (A unit's value follows from its gates' biases alone, a structured start of the kind
/// that Tallec and Ollivier, "Can recurrent neural networks warp time?", 2018, give gates.)
struct SlotCounters {
  Initial weight_ih, weight_hh, bias_ih, bias_hh;
  Initial head_weight, head_bias;
};

/// `features`: the LSTM's inputs. Without counters these are the published model's.
SlotCounters slot_counters(const ModelConfig& config, int64_t features);

}  // namespace vkopple
