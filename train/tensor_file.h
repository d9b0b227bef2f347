#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "train/stored_tensor.h"

namespace vkopple {

/// A file of named tensors in some format, whose values are read on demand. What is asked of a name that it
/// does not have is an Error naming file and tensor.
class TensorFile {
 public:
  TensorFile() = default;
  virtual ~TensorFile() = default;
  TensorFile(const TensorFile&) = delete;
  TensorFile& operator=(const TensorFile&) = delete;

  virtual const std::filesystem::path& path() const = 0;
  /// What the file says beside its tensors; empty where the format or the writer has nothing.
  virtual const std::map<std::string, std::string>& metadata() const = 0;
  virtual std::vector<std::string> names() const = 0;  ///< sorted
  virtual const StoredShape& shape(const std::string& name) const = 0;
  virtual StoredTensor read(const std::string& name) const = 0;
};

}  // namespace vkopple
