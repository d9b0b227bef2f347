#include "tools/command_tree/command_info.h"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>

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

struct Footer {
  std::vector<std::string> examples;
  std::string notes;
};

/// "Example: COMMAND" or "Examples: COMMAND", then lines with one more each below the first, and deeper ones
/// with the rest of a long one; what follows are notes.
Footer read_footer(const std::string& text) {
  constexpr size_t kColumn = std::string_view("Examples: ").size();
  Footer footer;
  std::istringstream lines(text);
  bool in_examples = true;
  for (std::string line; std::getline(lines, line);) {
    for (const std::string_view start : {"Example: ", "Examples: "})
      if (line.starts_with(start)) line.replace(0, start.size(), kColumn, ' ');
    const size_t begin = std::min(line.find_first_not_of(' '), line.size());
    in_examples = in_examples && begin >= kColumn;
    if (!in_examples)
      footer.notes += line + "\n";
    else if (begin == kColumn || footer.examples.empty())
      footer.examples.push_back(line.substr(begin));
    else
      footer.examples.back() += " \\\n    " + line.substr(begin);
  }
  return footer;
}

}  // namespace

CommandInfo describe(const CLI::App& command) {
  Footer footer = read_footer(command.get_footer());
  CommandInfo info{.name = command.get_name(),
                   .description = command.get_description(),
                   .examples = std::move(footer.examples),
                   .notes = std::move(footer.notes)};
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
