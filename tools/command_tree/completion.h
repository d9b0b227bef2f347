#pragma once

#include <string>
#include <vector>

#include "tools/command_tree/command_info.h"

namespace vkopple {

// Scripts with which shells complete commands, options and their choices; where anything may stand, file names.

std::string bash_completion(const std::vector<CommandInfo>& commands);
std::string zsh_completion(const std::vector<CommandInfo>& commands);
std::string fish_completion(const std::vector<CommandInfo>& commands);

}  // namespace vkopple
