#include "tools/command_tree/manual.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace vkopple {
namespace {

/// Text as roff shows it as it is.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool starts = out.empty() || out.back() == '\n';
    if (starts && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::string bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + escaped(text) + "\\fR"; }

std::string heading(const std::string& page, const std::string& version) {
  return fmt::format(".TH {} 1 \"\" \"vkopple {}\" \"User Commands\"\n", page, version);
}

std::string synopsis_of(const CommandInfo& command) {
  std::string line = bold("vkopple " + command.name) + " [" + italic("OPTION") + "]...";
  for (const OptionInfo& option : command.options) {
    if (option.positional) {
      const std::string name = italic(option.names.front()) + (option.repeats ? "..." : "");
      line += option.required ? " " + name : " [" + name + "]";
    } else if (option.required) {
      line += " " + bold(option.names.back()) + " " + italic(option.value);
    }
  }
  return line;
}

std::string option_entry(const OptionInfo& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back(option.positional ? italic(name) : bold(name));
  std::string text = fmt::format(".TP\n{}", fmt::join(names, ", "));
  if (!option.positional && !option.value.empty())
    text += " " + (option.choices.empty() ? italic(option.value)
                                          : escaped(fmt::format("{}", fmt::join(option.choices, "|"))));
  text += "\n" + escaped(option.description);
  if (option.positional && !option.choices.empty())
    text += escaped(fmt::format(" ({})", fmt::join(option.choices, ", ")));
  if (!option.standard.empty()) text += escaped(fmt::format(" (default: {})", option.standard));
  return text + "\n";
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n0; 1, the work failed; 2, wrong use. What is wrong stands in one line on standard "
    "error.\n";
constexpr const char* kEnvironment =
    ".SH ENVIRONMENT\n.TP\n\\fBVKOPPLE_DEVICE\\fR\nThe Vulkan device, where \\fB\\-\\-device\\fR does not say "
    "it.\n"
    ".TP\n\\fBXDG_CACHE_HOME\\fR\nIts folder vkopple keeps pipelines and tuned tiles (default: ~/.cache).\n";

}  // namespace

std::string program_manual(const CommandInfo& program, const std::vector<CommandInfo>& commands,
                           const std::string& version) {
  std::string text =
      heading("VKOPPLE", version) + ".SH NAME\nvkopple \\- objects, their place and depth from video\n";
  text += ".SH SYNOPSIS\n" + bold("vkopple") + " " + italic("COMMAND") + " [" + italic("ARGUMENT") + "]...\n";
  text += ".SH DESCRIPTION\n" + escaped(program.description) + "\n.SH COMMANDS\n";
  for (const CommandInfo& command : commands)
    text += fmt::format(".TP\n{}(1)\n{}\n", bold("vkopple-" + command.name), escaped(command.description));
  return text + kExitStatus + kEnvironment;
}

std::string command_manual(const CommandInfo& command, const std::string& version) {
  const std::string page = "vkopple-" + command.name;
  std::string text = heading(fmt::format("\"{}\"", page), version);
  text += fmt::format(".SH NAME\n{} \\- {}\n", escaped(page), escaped(command.description));
  text += ".SH SYNOPSIS\n" + synopsis_of(command) + "\n.SH OPTIONS\n";
  for (const OptionInfo& option : command.options) text += option_entry(option);
  if (!command.examples.empty()) text += ".SH EXAMPLES\n";
  for (const std::string& example : command.examples) text += ".nf\n" + escaped(example) + "\n.fi\n";
  if (!command.notes.empty()) text += ".SH NOTES\n.nf\n" + escaped(command.notes) + ".fi\n";
  return text + kExitStatus + kEnvironment + ".SH SEE ALSO\n" + bold("vkopple") + "(1)\n";
}

}  // namespace vkopple
