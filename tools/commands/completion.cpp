#include <fmt/format.h>

#include <memory>
#include <string>

#include "tools/command.h"
#include "tools/command_tree/completion.h"

namespace vkopple {
namespace {

std::string script_for(const std::string& shell, const std::vector<CommandInfo>& commands) {
  if (shell == "bash") return bash_completion(commands);
  if (shell == "zsh") return zsh_completion(commands);
  return fish_completion(commands);
}

}  // namespace

void add_completion(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("completion", "Print a script that completes command lines in a shell");
  const auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "The shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->footer(
      "Examples: vkopple completion bash >~/.local/share/bash-completion/completions/vkopple\n"
      "          vkopple completion fish >~/.config/fish/completions/vkopple.fish");
  command->callback(
      [command, shell] { fmt::print("{}", script_for(*shell, describe_commands(program_of(*command)))); });
}

}  // namespace vkopple
