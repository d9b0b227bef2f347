#pragma once

#include <map>
#include <string>
#include <vector>

namespace vkopple {

/// A name that a format understands, for `--help` and messages.
struct NamedHelp {
  std::string name, help;
};

/// What a user says of a foreign data set that its files don't. Names were checked against the format's lists
/// before a reader sees them.
struct FormatOptions {
  std::map<std::string, std::string> settings;  ///< NAME=VALUE
  std::map<std::string, std::string> fields;    ///< --map OURS=THEIRS,...: what the file calls a field
  std::string option = "--format-option";       ///< by which settings were given, for messages

  /// A setting, or `otherwise` where it wasn't given.
  std::string text(const std::string& name, const std::string& otherwise) const;
  /// One of `choices`; else UsageError.
  std::string choice(const std::string& name, const std::vector<std::string>& choices,
                     const std::string& otherwise) const;
  /// From `lowest` to `highest`; else UsageError.
  double number(const std::string& name, double lowest, double highest, double otherwise) const;
  /// A whole number, likewise.
  long integer(const std::string& name, long lowest, long highest, long otherwise) const;
  /// An angle given in degrees, in radians.
  double degrees(const std::string& name, double lowest, double highest, double otherwise) const;

  /// What the file calls our field `name`: as mapped, or `otherwise`.
  std::string field(const std::string& name, const std::string& otherwise) const;
};

/// "a=b,c=d" added to `to`. Throws UsageError, which names `option`, where it is not of that form or gives a
/// name twice.
void add_assignments(const std::string& text, const std::string& option,
                     std::map<std::string, std::string>& to);

}  // namespace vkopple
