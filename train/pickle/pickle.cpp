#include "train/pickle/pickle.h"

#include <fmt/format.h>

#include "runtime/error.h"
#include "train/pickle/pickle_machine.h"
#include "train/quote.h"

namespace vkopple {

Pickle::Pickle(std::span<const std::byte> bytes, const std::string& source,
               const std::set<std::string>& allowed, const PickleLimits& limits)
    : source_(one_line(source, 4096)) {
  PickleInput input(bytes, source_);
  root_ = PickleMachine(input, arena_, allowed, limits.max_values).run();
  if (!within_depth(root_, limits.max_depth))
    throw Error(
        fmt::format("{}: it is nested deeper than {} levels, or contains itself", source_, limits.max_depth));
}

}  // namespace vkopple
