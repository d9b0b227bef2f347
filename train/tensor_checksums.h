#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "train/stored_tensor.h"

namespace vkopple {

/// What a safetensors file says of its own content, against damage on a disk or on the way, in two keys of its
/// metadata:
///   crc32c           JSON: by a tensor's name the CRC-32C of the text "F32 [2, 3]" that tells its type and
///                    shape, followed by its bytes; eight hexadecimal digits
///   metadata_crc32c  the CRC-32C of all other metadata, sorted: of every key and its text, a zero byte after
///                    each
/// A file without the first is one that has no checksums, and is taken as it is.
class TensorChecksums {
 public:
  /// Of the metadata of the file `path`. Throws Error naming the file where they are damaged.
  TensorChecksums(const std::map<std::string, std::string>& metadata, std::filesystem::path path);

  /// Throws Error naming file and tensor where it is not what was written.
  void check(const std::string& name, const TensorView& tensor) const;

 private:
  std::filesystem::path path_;
  bool present_ = false;
  std::map<std::string, std::string> tensors_;
};

/// Metadata with the two keys, for a file of these tensors.
std::map<std::string, std::string> with_checksums(std::map<std::string, std::string> metadata,
                                                  const std::map<std::string, StoredTensor>& tensors);
/// Metadata without them: of a file whose tensors are changed.
std::map<std::string, std::string> without_checksums(std::map<std::string, std::string> metadata);

}  // namespace vkopple
