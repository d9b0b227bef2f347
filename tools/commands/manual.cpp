#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "runtime/error.h"
#include "tools/command.h"
#include "tools/command_tree/manual.h"

namespace vkopple {
namespace {

std::string page(const CLI::App& program, const std::string& name) {
  const auto commands = describe_commands(program);
  if (name.empty()) return program_manual(describe(program), commands, VKOPPLE_VERSION);
  const auto found =
      std::find_if(commands.begin(), commands.end(), [&](const CommandInfo& c) { return c.name == name; });
  if (found == commands.end())
    throw UsageError(fmt::format("there is no command {} (see vkopple --help)", name));
  return command_manual(*found, VKOPPLE_VERSION);
}

}  // namespace

void add_manual(CLI::App& app) {
  CLI::App* command = app.add_subcommand("manual", "Print the manual page of a command, for man");
  const auto name = std::make_shared<std::string>();
  command->add_option("command", *name, "The command; without one, the page that lists them all");
  command->footer("Example: vkopple manual train | man -l -");
  command->callback([command, name] { fmt::print("{}", page(program_of(*command), *name)); });
}

}  // namespace vkopple
