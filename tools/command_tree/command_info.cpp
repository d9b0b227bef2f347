#include "tools/command_tree/command_info.h"

#include <algorithm>
#include <sstream>
#include <string_view>

namespace vkopple {
namespace {

constexpr int kEndless = CLI::detail::expected_max_vector_size;

/// "TEXT:{a,b}" tells choices, "UINT:INT in [1 - 4]" a range.
std::vector<std::string> choices_in(const std::string& type) {
  const size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  std::istringstream list(type.substr(open + 1, close - open - 1));
  std::vector<std::string> choices;
  for (std::string choice; std::getline(list, choice, ',');) choices.push_back(choice);
  return choices;
}

OptionInfo describe_option(const CLI::Option& option) {
  OptionInfo info;
  info.positional = option.get_positional();
  for (const std::string& name : option.get_snames()) info.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) info.names.push_back("--" + name);
  if (info.names.empty()) info.names.push_back(option.get_name(true));
  const std::string type = option.get_type_name();
  if (option.get_items_expected_max() > 0) {
    info.choices = choices_in(type);
    info.value = type.substr(0, type.find(':'));
    if (info.value.empty()) info.value = "TEXT";
  }
  info.standard = option.get_default_str();
  info.description = option.get_description();
  info.required = option.get_required();
  info.repeats = option.get_expected_max() >= kEndless;
  return info;
}

/// A footer is "Example: COMMAND" or "Examples: COMMAND", then lines with one more each.
std::vector<std::string> examples_in(const std::string& footer) {
  std::vector<std::string> examples;
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    for (const std::string_view start : {"Example:", "Examples:"})
      if (line.starts_with(start)) line.erase(0, start.size());
    const size_t begin = line.find_first_not_of(' ');
    if (begin != std::string::npos) examples.push_back(line.substr(begin));
  }
  return examples;
}

}  // namespace

CommandInfo describe(const CLI::App& command) {
  CommandInfo info{command.get_name(), command.get_description(), examples_in(command.get_footer()), {}};
  for (const CLI::Option* option : command.get_options({})) info.options.push_back(describe_option(*option));
  std::stable_partition(info.options.begin(), info.options.end(),
                        [](const OptionInfo& o) { return o.positional; });
  return info;
}

std::vector<CommandInfo> describe_commands(const CLI::App& program) {
  std::vector<CommandInfo> all;
  for (const CLI::App* command : program.get_subcommands({})) all.push_back(describe(*command));
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return all;
}

const CLI::App& program_of(const CLI::App& command) {
  const CLI::App* app = &command;
  while (app->get_parent() != nullptr) app = app->get_parent();
  return *app;
}

}  // namespace vkopple
