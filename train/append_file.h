#pragma once

#include <filesystem>
#include <string_view>

#include "train/file_descriptor.h"
#include "train/file_system.h"

namespace vkopple {

/// A file that grows: a log. What is added is on its way to the disk when add() returns, and the end of what a
/// failure or a crash cut off may stand there in part. Throws Error naming the file.
class AppendFile {
 public:
  /// Made where there is none.
  explicit AppendFile(std::filesystem::path path, FileSystem& files = system_files());

  void add(std::string_view text);

  const std::filesystem::path& path() const { return path_; }

 private:
  [[noreturn]] void fail(int code) const;

  std::filesystem::path path_;
  FileSystem* files_;
  FileDescriptor file_;
};

}  // namespace vkopple
