#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "train/stored_tensor.h"
#include "train/tensor_file.h"

namespace vkopple {

class PickleView;

/// What torch.save writes of a dict of tensors (a state dict), PyTorch 1.6 and later: a zip of NAME/data.pkl, a
/// pickle that describes the tensors, and NAME/data/KEY, the bytes of their storages. Executes nothing;
/// anything but tensors is refused by name, and so are tensors that reach beyond their storage.
class TorchFile : public TensorFile {
 public:
  explicit TorchFile(std::filesystem::path path);

  const std::filesystem::path& path() const override { return path_; }
  /// Of files that write_torch has made.
  const std::map<std::string, std::string>& metadata() const override { return metadata_; }
  std::vector<std::string> names() const override;
  const StoredShape& shape(const std::string& name) const override { return entry(name).shape; }
  /// Row-major, whatever the strides in the file.
  StoredTensor read(const std::string& name) const override;

 private:
  /// Elements of a storage: offset + Σ index · stride.
  struct Entry {
    StoredType dtype;
    StoredShape shape;
    std::vector<std::int64_t> strides;
    std::int64_t offset = 0;
    std::string storage;
  };

  void read_members();
  void read_metadata(const std::string& text);
  void read_entries(const std::vector<std::byte>& pickle);
  Entry read_entry(const PickleView& view) const;
  void read_storage(const PickleView& view, Entry& entry) const;
  void check_reach(const PickleView& view, const Entry& entry) const;
  const Entry& entry(const std::string& name) const;

  std::filesystem::path path_;
  std::map<std::string, std::string> metadata_;
  std::map<std::string, std::vector<std::byte>> storages_;  ///< by key
  std::map<std::string, Entry> entries_;
};

/// Whether a path ends as the files of PyTorch do: .pt or .pth.
bool has_torch_ending(const std::filesystem::path& path);

/// Writes such a file through AtomicFile; torch.load(path, weights_only=True) reads it as an OrderedDict of
/// tensors on the CPU and knows nothing of `metadata`. The same content gives the same bytes. Throws Error for
/// element types that PyTorch's storages don't have.
void write_torch(const std::filesystem::path& path, const std::map<std::string, std::string>& metadata,
                 const std::map<std::string, StoredTensor>& tensors);

}  // namespace vkopple
