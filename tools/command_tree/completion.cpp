#include "tools/command_tree/completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

namespace vkopple {
namespace {

std::string names_of(const std::vector<CommandInfo>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const CommandInfo& command : commands) names.push_back(command.name);
  return fmt::format("{}", fmt::join(names, " "));
}

/// What a word that is not an option's value can be: options, and choices of positional arguments.
std::string words_of(const CommandInfo& command) {
  std::vector<std::string> words;
  for (const OptionInfo& option : command.options) {
    const auto& more = option.positional ? option.choices : option.names;
    words.insert(words.end(), more.begin(), more.end());
  }
  return fmt::format("{}", fmt::join(words, " "));
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

/// Within single quotes of a POSIX shell, which zsh has as well.
std::string quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

/// Of a description within [...] of zsh's _arguments.
std::string zsh_escaped(std::string text) {
  for (const char* special : {"\\", "[", "]", ":"}) text = replaced(text, special, std::string("\\") + special);
  return text;
}

std::string bash_values(const CommandInfo& command) {
  std::string cases;
  for (const OptionInfo& option : command.options) {
    if (option.positional || option.value.empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : option.names) patterns.push_back(fmt::format("'{} {}'", command.name, name));
    cases += fmt::format("    {}) words='{}' ;;\n", fmt::join(patterns, "|"), fmt::join(option.choices, " "));
  }
  return cases;
}

std::string zsh_arguments(const CommandInfo& command) {
  std::string lines;
  for (const OptionInfo& option : command.options) {
    const std::string values =
        option.choices.empty() ? "_files" : fmt::format("({})", fmt::join(option.choices, " "));
    const std::string argument =
        option.value.empty() ? "" : fmt::format(":{}:{}", zsh_escaped(option.value), values);
    if (option.positional) {
      lines +=
          fmt::format(" \\\n        {}",
                      quoted(fmt::format("{}:{}:{}", option.repeats ? "*" : "", option.names.front(), values)));
      continue;
    }
    for (const std::string& name : option.names)
      lines += fmt::format(" \\\n        {}", quoted(fmt::format("{}{}[{}]{}", option.repeats ? "*" : "", name,
                                                                 zsh_escaped(option.description), argument)));
  }
  return lines;
}

std::string fish_lines(const CommandInfo& command) {
  const std::string when = fmt::format("complete -c vkopple -n '__fish_seen_subcommand_from {}'", command.name);
  std::string lines;
  for (const OptionInfo& option : command.options) {
    const std::string choices =
        option.choices.empty() ? "" : fmt::format(" -a '{}'", fmt::join(option.choices, " "));
    if (option.positional) {
      if (!choices.empty()) lines += when + choices + "\n";
      continue;
    }
    for (const std::string& name : option.names) {
      const bool is_long = name.starts_with("--");
      const std::string takes = option.value.empty() ? "" : option.choices.empty() ? " -r" : " -x" + choices;
      lines += fmt::format("{} -{} {}{} -d {}\n", when, is_long ? "l" : "s", name.substr(is_long ? 2 : 1),
                           takes, fish_quoted(option.description));
    }
  }
  return lines;
}

}  // namespace

std::string bash_completion(const std::vector<CommandInfo>& commands) {
  std::string values, words;
  for (const CommandInfo& command : commands) {
    values += bash_values(command);
    words += fmt::format("      {}) words='{}' ;;\n", command.name, words_of(command));
  }
  return fmt::format(R"(# bash completion for vkopple, written by `vkopple completion bash`.
_vkopple() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} command=${{COMP_WORDS[1]}} words
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W '{} --help --version' -- "$current")
    return
  fi
  # --option=value comes as three words.
  if [[ $current == = ]]; then
    current=
  elif [[ $previous == = ]]; then
    previous=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
  case "$command $previous" in
{}    *)
      case $command in
{}      *) words= ;;
      esac
      ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}}
complete -o default -F _vkopple vkopple
)",
                     names_of(commands), values, words);
}

std::string zsh_completion(const std::vector<CommandInfo>& commands) {
  std::string list, cases;
  for (const CommandInfo& command : commands) {
    list += fmt::format("    {}\n", quoted(replaced(command.name, ":", "\\:") + ":" + command.description));
    cases += fmt::format("    {})\n      _arguments{}\n      ;;\n", command.name, zsh_arguments(command));
  }
  return fmt::format(R"(#compdef vkopple
# zsh completion for vkopple, written by `vkopple completion zsh`.
_vkopple() {{
  local -a commands=(
{}  )
  if ((CURRENT == 2)); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{}  esac
}}
if [[ $funcstack[1] == _vkopple ]]; then
  _vkopple "$@"
else
  compdef _vkopple vkopple
fi
)",
                     list, cases);
}

std::string fish_completion(const std::vector<CommandInfo>& commands) {
  std::string lines = "# fish completion for vkopple, written by `vkopple completion fish`.\n";
  for (const CommandInfo& command : commands)
    lines += fmt::format("complete -c vkopple -n __fish_use_subcommand -f -a {} -d {}\n", command.name,
                         fish_quoted(command.description));
  lines += "complete -c vkopple -n __fish_use_subcommand -f -l version -d 'Print the version and leave'\n";
  for (const CommandInfo& command : commands) lines += fish_lines(command);
  return lines;
}

}  // namespace vkopple
