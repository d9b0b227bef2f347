#pragma once

#include <string>
#include <vector>

#include "tools/command_tree/command_info.h"

namespace vkopple {

// Manual pages of section 1, for man(1).

/// vkopple(1), which lists the commands. `program` is the program itself.
std::string program_manual(const CommandInfo& program, const std::vector<CommandInfo>& commands,
                           const std::string& version);
/// vkopple-COMMAND(1).
std::string command_manual(const CommandInfo& command, const std::string& version);

}  // namespace vkopple
