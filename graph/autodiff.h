#pragma once

#include <string>
#include <vector>

#include "graph/graph.h"

namespace vkopple {

/// The backward pass of one node. Entries of `wants` and `accumulate` follow the node's inputs.
struct BackwardStep {
  size_t node = 0;
  std::vector<uint8_t> wants;
  std::vector<uint8_t> accumulate;
  std::vector<int> zero_roots;  ///< gradients of these roots are set to zero before the step
};

/// The reverse walk: which nodes run backward, in which order, and who overwrites and who adds to a gradient.
/// Roots in `zero_first` are set to zero before all steps: the gradients of the trained groups, whose members
/// only add.
struct BackwardPlan {
  std::vector<BackwardStep> steps;
  std::vector<int> zero_first;
};

/// `loss`: a value of one element; `trained`: names of parameter groups. Throws Error where the loss depends on
/// no trained group or a node reads the same tensor twice.
BackwardPlan plan_backward(Graph& graph, Value loss, const std::vector<std::string>& trained);

/// Operations of a backward step out of the `full` that its op's Needs state for all gradients: of a product of
/// inputs 0 and 1 of which only one wants its gradient, half.
double backward_flop(const Node& node, const BackwardStep& step, double full);

}  // namespace vkopple
