#include "train/exchange/tensor_file.h"

#include "train/exchange/stored_zip.h"
#include "train/exchange/torch_file.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

class SafetensorsSource : public TensorFile {
 public:
  explicit SafetensorsSource(const std::filesystem::path& path) : file_(path) {}
  const std::filesystem::path& path() const override { return file_.path(); }
  const std::map<std::string, std::string>& metadata() const override { return file_.metadata(); }
  std::vector<std::string> names() const override { return file_.names(); }
  const StoredShape& shape(const std::string& name) const override { return file_.shape(name); }
  StoredTensor read(const std::string& name) const override { return file_.read(name); }

 private:
  SafetensorsFile file_;
};

}  // namespace

std::unique_ptr<TensorFile> open_tensor_file(const std::filesystem::path& path) {
  if (is_zip(path) || has_torch_ending(path)) return std::make_unique<TorchFile>(path);
  return std::make_unique<SafetensorsSource>(path);
}

}  // namespace vkopple
