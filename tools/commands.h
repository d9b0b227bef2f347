#pragma once

#include <vector>

#include "tools/command.h"

namespace vkopple {

/// Every subcommand that the build found in tools/commands.
std::vector<AddCommand> all_commands();

}  // namespace vkopple
