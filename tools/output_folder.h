#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace vkopple {

/// The folder that a command writes its files to, made where there is none.
class OutputFolder {
 public:
  /// Throws Error where it cannot be.
  explicit OutputFolder(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// What the results of an input file are called: its name without the extension, with a number behind it
  /// where that was given to another input before.
  std::string name_for(const std::filesystem::path& input);
  /// A name with a number behind it where it was given before.
  std::string unique_name(const std::string& name);

 private:
  std::filesystem::path path_;
  std::set<std::string> names_;
};

}  // namespace vkopple
