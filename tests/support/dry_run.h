#pragma once

#include <functional>
#include <string>
#include <vector>

#include "graph/graph.h"
#include "runtime/dispatch.h"

namespace vkopple::test {

using DispatchSink = std::function<void(const Node& node, const Dispatch& dispatch)>;

/// Tells of every dispatch by which a device of such caps would run a graph: forward, then the gradients of the
/// groups `trained` of `loss` where there is one, then the updates. No device is needed: every tensor lies
/// somewhere of its own, at an offset that can be bound. Throws what recording throws, starting with the node's
/// scope.
void dry_run(Graph& graph, Value loss, const std::vector<std::string>& trained, const Caps& caps,
             const DispatchSink& sink);

}  // namespace vkopple::test
