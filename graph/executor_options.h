#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "graph/graph.h"

namespace vkopple {

class GroupStore;

struct ExecutorOptions {
  std::shared_ptr<GroupStore> groups;           ///< null: groups of its own
  Value loss;                                   ///< none: inference, forward alone
  std::vector<std::string> trained;             ///< parameter groups that receive gradients
  Value loss_scale;                             ///< row-major; its first element is the loss' gradient. None: 1
  bool profile = false;                         ///< timestamps around every command
  uint64_t recompute_from = uint64_t{1} << 18;  ///< bytes from which backward recomputes what is cheap to
  /// Told in every backward, for each trained group that has a gradient, when that is complete and others may
  /// be still to come: on the host, which may read it. Null: nobody is told.
  std::function<void(const std::string& group)> gradient_done;
  bool in_place = true;  ///< outputs take over the bytes of inputs where ops allow it
  /// Backward passes that make the gradient of one update together: the mean of theirs.
  int portions = 1;
};

}  // namespace vkopple
