#include "train/require_numbers.h"

#include <algorithm>
#include <cmath>

#include "runtime/error.h"

namespace vkopple {

void require_numbers(std::span<const float> values) {
  if (std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); })) return;
  throw Error("what the model infers is not a finite number; its weights are unusable, train it again");
}

}  // namespace vkopple
