#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "graph/profile.h"

namespace vkopple {

/// The nodes of a profile that do the same work, taken together.
struct OpRow {
  std::string op;
  std::string pass;   ///< forward, backward or update
  std::string shape;  ///< "3x3 s1 [12,64,128,128] -> 64"; empty where rows are by op alone
  size_t count = 0;
  double seconds = 0;  ///< of device time
  double share = 0;    ///< of the device time of all passes
  double gflop = 0;    ///< of convolutions and products
  double gbytes = 0;   ///< that must be read and written
  double gflops() const { return seconds > 0 ? gflop / seconds : 0; }
};

enum class OpRows { kByOp, kByShape };

/// Longest first.
std::vector<OpRow> op_table(const std::vector<PassProfile>& passes, OpRows rows);

/// What a node works on, in short: kernel and stride of a convolution, the first input's shape and the first
/// output's, of which only the channels where nothing else tells.
std::string shape_text(const NodeProfile& node);

}  // namespace vkopple
