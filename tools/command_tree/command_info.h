#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace vkopple {

// The program's commands as manuals and shell completions need them, read from the tree that parses the command
// line: what a command takes can't be told differently from what it is.

struct OptionInfo {
  std::vector<std::string> names;    ///< "--out", "-h"; one name without dashes for a positional argument
  std::string value;                 ///< "TEXT"; empty for a flag
  std::vector<std::string> choices;  ///< all values there are; empty: anything, as a file's name
  std::string standard;              ///< the default, where it is told
  std::string description;
  bool positional = false;
  bool required = false;
  bool repeats = false;
};

struct CommandInfo {
  std::string name;
  std::string description;
  std::vector<std::string> examples;  ///< command lines, with a backslash where they go on below
  std::string notes;                  ///< lines of what else there is to tell; may be empty
  std::vector<OptionInfo> options;    ///< positional ones first, in their order
};

/// A command, or the program itself.
CommandInfo describe(const CLI::App& command);
/// All commands of the program, by name.
std::vector<CommandInfo> describe_commands(const CLI::App& program);

/// The program that a command belongs to.
const CLI::App& program_of(const CLI::App& command);

}  // namespace vkopple
