#pragma once

#include <map>
#include <string>

#include "train/stored_tensor.h"

namespace vkopple {

/// Changes a model's float32 weights so that its networks take and give blue, green, red where they took and
/// gave red, green, blue; done twice, nothing has changed. Images enter the first convolution of every network
/// and leave the last one of the imagination network.
void swap_red_and_blue(std::map<std::string, StoredTensor>& tensors);

}  // namespace vkopple
