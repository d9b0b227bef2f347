#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graph/tensor.h"
#include "runtime/recorder.h"

namespace vkopple {

/// One node of a graph in the last run of one pass.
struct NodeProfile {
  std::string op;  ///< with " again" where backward repeats a forward pass; or "fill" and "copy" for what the
                   ///< executor itself records between nodes
  std::string scope;  ///< where it belongs: "depth/down1"
  std::vector<TensorSpec> inputs;
  std::vector<TensorSpec> outputs;
  double flop = 0;     ///< of convolutions and products in this pass, a multiply and an add counting one each
  uint64_t bytes = 0;  ///< of the tensors that the pass must read or write, each counted once, without scratch
  std::vector<CommandTime> commands;  ///< not empty

  double begin() const { return commands.front().begin; }  ///< seconds on the device's clock
  double end() const { return commands.back().end; }
  double seconds() const { return end() - begin(); }
};

/// The last run of a pass: "forward", "backward" or "update".
struct PassProfile {
  std::string name;
  RunTimes host;
  std::vector<NodeProfile> nodes;  ///< in the order in which they ran; empty without profiling

  /// Seconds of device time.
  double seconds() const { return nodes.empty() ? 0 : nodes.back().end() - nodes.front().begin(); }
};

}  // namespace vkopple
