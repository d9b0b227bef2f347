#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "train/file_descriptor.h"
#include "train/file_system.h"
#include "train/stored_tensor.h"
#include "train/tensor_checksums.h"
#include "train/tensor_file.h"

namespace vkopple {

/// A safetensors file, opened and checked as a whole, its tensors read on demand.
///
/// Layout: 8 bytes little-endian header length (at most 100 MB), a JSON object {name: {dtype, shape,
/// data_offsets}} with an optional "__metadata__" of strings, then the data, which the tensors tile without
/// hole or overlap. Whatever breaks this is an Error that names the file, the tensor and what is wrong, and so
/// is a tensor that belies the file's checksums (train/tensor_checksums.h), where it has some, when it is read.
class SafetensorsFile : public TensorFile {
 public:
  explicit SafetensorsFile(std::filesystem::path path);

  const std::filesystem::path& path() const override { return path_; }
  const std::map<std::string, std::string>& metadata() const override { return metadata_; }
  std::vector<std::string> names() const override;
  const StoredShape& shape(const std::string& name) const override { return entry(name).shape; }
  StoredTensor read(const std::string& name) const override;

  bool contains(const std::string& name) const { return entries_.contains(name); }
  /// This and all below throw an Error naming file and tensor when there is no such tensor.
  StoredType dtype(const std::string& name) const { return entry(name).dtype; }

  std::vector<float> read_floats(const std::string& name) const;
  std::vector<double> read_doubles(const std::string& name) const;
  std::vector<std::int64_t> read_ints(const std::string& name) const;

  /// Also refuses another shape, and values that are not finite: what weights must go through.
  std::vector<float> read_floats(const std::string& name, const StoredShape& expected) const;

 private:
  struct Entry {
    StoredType dtype;
    StoredShape shape;
    std::uint64_t begin, end;  ///< bytes, counted from the start of the data
  };
  class HeaderReader;

  const Entry& entry(const std::string& name) const;

  std::filesystem::path path_;
  FileDescriptor file_;
  std::uint64_t data_start_ = 0;
  std::map<std::string, std::string> metadata_;
  std::map<std::string, Entry> entries_;
  std::optional<TensorChecksums> checksums_;
};

/// Writes a file through AtomicFile. The same content gives the same bytes: tensors lie by falling element size
/// (so each is aligned), then by name, and spaces fill the header to a multiple of 8 bytes.
void write_safetensors(const std::filesystem::path& path, const std::map<std::string, std::string>& metadata,
                       const std::map<std::string, TensorView>& tensors, FileSystem& files = system_files());
void write_safetensors(const std::filesystem::path& path, const std::map<std::string, std::string>& metadata,
                       const std::map<std::string, StoredTensor>& tensors, FileSystem& files = system_files());

}  // namespace vkopple
