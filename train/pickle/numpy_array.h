#pragma once

#include <optional>
#include <set>
#include <string>

#include "train/pickle/pickle_value.h"
#include "train/stored_tensor.h"

namespace vkopple {

/// The globals by which numpy's arrays and single numbers are pickled, to be allowed.
const std::set<std::string>& numpy_globals();

/// An array or a single number (of shape []) of numpy, row-major; nothing where the value is neither, or holds
/// other than numbers in little-endian order and truth values, or as many bytes as its shape does not have.
std::optional<StoredTensor> numpy_array(const PickleValue& value);

}  // namespace vkopple
