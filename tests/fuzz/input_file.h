#pragma once

#include <filesystem>

#include "tests/fuzz/fuzz.h"
#include "train/file_descriptor.h"

namespace vkopple::fuzz {

/// A file in memory, with a path while this lives, for parsers that open files themselves.
class InputFile {
 public:
  explicit InputFile(Input content);

  const std::filesystem::path& path() const { return path_; }

 private:
  FileDescriptor file_;
  std::filesystem::path path_;
};

}  // namespace vkopple::fuzz
