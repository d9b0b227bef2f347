#include "graph/conv/winograd.h"

#include <algorithm>

namespace vkopple {

bool can_winograd(const ConvShape& s, WinogradTile tile, const Caps& caps) {
  if (s.kernel != 3 || s.stride != 1 || s.dilation != 1) return false;
  // Lanes 0 to 7 of every subgroup must be there to fetch what 8 channels or tiles share.
  if (!caps.subgroup_shuffle || caps.subgroup_size < 8 || caps.subgroup_size > 128) return false;
  return std::max({winograd_product_scratch(s, ConvDirection::kForward, tile, caps),
                   winograd_product_scratch(s, ConvDirection::kTransposed, tile, caps)}) <=
         caps.max_tensor_bytes();
}

}  // namespace vkopple
