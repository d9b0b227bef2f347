#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "train/formats/scene_reader.h"

namespace vkopple {

/// How a data set of another format is read.
struct ForeignData {
  std::string format;  ///< empty: as the path tells
  std::vector<std::string> settings, fields;

  FormatOptions options() const {
    FormatOptions made;
    for (const std::string& text : settings) add_assignments(text, made.option, made.settings);
    for (const std::string& text : fields) add_assignments(text, "--map", made.fields);
    return made;
  }
  std::unique_ptr<SceneReader> open(const std::string& path) const {
    return open_scenes(path, format, options());
  }
};

/// Adds `--format`, `--format-option` and `--map`.
inline void add_foreign_data_options(CLI::App& command, ForeignData& data) {
  command.add_option("--format", data.format, "The format's name (default: what the path looks like)");
  command
      .add_option("--format-option", data.settings,
                  "NAME=VALUE,...: what the files don't tell; may be repeated. See the list below")
      ->allow_extra_args(false);
  command.add_option("--map", data.fields, "FIELD=NAME,...: what the files call a field; may be repeated")
      ->allow_extra_args(false);
}

/// What a command does with formats.
enum class FormatUse { kReading, kConverting };

/// The formats with their options, for a command's help.
inline std::string formats_help(FormatUse use) {
  std::string text = "Formats:\n";
  for (const SceneFormat& format : scene_formats()) {
    text += fmt::format("  {:<12}{}{}\n", format.name, format.about,
                        format.create == nullptr ? "" : " (written too)");
    for (const NamedHelp& setting : format.settings)
      text += fmt::format("    {:<18}{}\n", setting.name, setting.help);
    for (const NamedHelp& field : format.fields)
      text += fmt::format("    --map {:<12}{}\n", field.name, field.help);
    if (use == FormatUse::kReading) continue;
    for (const NamedHelp& setting : format.write_settings)
      text += fmt::format("    --to-option {:<18}{}\n", setting.name, setting.help);
  }
  return text;
}

}  // namespace vkopple
