#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "runtime/error.h"
#include "train/archive_writer.h"
#include "train/exchange/torch_file.h"
#include "train/exchange/torch_types.h"
#include "train/json_io.h"
#include "train/quote.h"

namespace vkopple {
namespace {

std::string_view storage_of(const std::filesystem::path& path, const std::string& name, StoredType dtype) {
  const auto* found = std::find_if(std::begin(kTorchStorages), std::end(kTorchStorages),
                                   [&](const TorchStorage& s) { return s.dtype == dtype; });
  if (found == std::end(kTorchStorages))
    throw Error(fmt::format("cannot write {}: PyTorch has no storage for the {} of tensor {}",
                            one_line(path.string(), 4096), dtype_name(dtype), quote(name)));
  return found->name;
}

/// The instructions of a pickle in protocol 2, which is what torch.save takes.
class PickleText {
 public:
  void raw(std::string_view instructions) { text_ += instructions; }
  void global(std::string_view module, std::string_view name) {
    text_ += fmt::format("c{}\n{}\n", module, name);
  }
  void string(std::string_view text) {
    text_ += 'X';
    little(text.size(), 4);
    text_ += text;
  }
  void whole(std::int64_t number) {
    raw("\x8a\x08");
    little(static_cast<std::uint64_t>(number), 8);
  }
  void tuple(const std::vector<std::int64_t>& numbers) {
    text_ += '(';
    for (const std::int64_t number : numbers) whole(number);
    text_ += 't';
  }
  const std::string& text() const { return text_; }

 private:
  void little(std::uint64_t number, int bytes) {
    for (int i = 0; i < bytes; ++i) text_ += static_cast<char>(static_cast<unsigned char>(number >> 8 * i));
  }

  std::string text_;
};

std::vector<std::int64_t> strides_of(const StoredShape& shape) {
  std::vector<std::int64_t> strides(shape.size(), 1);
  for (std::size_t i = shape.size(); i-- > 1;)
    strides[i - 1] = strides[i] * std::max<std::int64_t>(shape[i], 1);
  return strides;
}

void write_entry(PickleText& out, std::string_view storage, std::size_t key, const StoredTensor& tensor) {
  out.global("torch._utils", "_rebuild_tensor_v2");
  out.raw("((");
  out.string("storage");
  out.global("torch", storage);
  out.string(std::to_string(key));
  out.string("cpu");
  out.whole(element_count(tensor.shape).value());
  out.raw("tQ");
  out.whole(0);
  out.tuple(tensor.shape);
  out.tuple(strides_of(tensor.shape));
  out.raw("\x89");  // requires no gradient
  out.global("collections", "OrderedDict");
  out.raw(")RtR");
}

}  // namespace

void write_torch(const std::filesystem::path& path, const std::map<std::string, std::string>& metadata,
                 const std::map<std::string, StoredTensor>& tensors) {
  PickleText pickle;
  pickle.raw("\x80\x02");
  pickle.global("collections", "OrderedDict");
  pickle.raw(")R(");
  std::size_t key = 0;
  for (const auto& [name, tensor] : tensors) {
    pickle.string(name);
    write_entry(pickle, storage_of(path, name, tensor.dtype), key++, tensor);
  }
  pickle.raw("u.");

  ArchiveWriter zip(path, ArchiveKind::kStoredZip);
  const auto add = [&](std::string_view name, std::string_view text) {
    zip.add(fmt::format("archive/{}", name), std::as_bytes(std::span(text)));
  };
  add("data.pkl", pickle.text());
  add("byteorder", "little");
  key = 0;
  for (const auto& item : tensors) zip.add(fmt::format("archive/data/{}", key++), item.second.bytes);
  add("version", "3\n");
  if (!metadata.empty())
    add(kTorchMetadataMember, Json(metadata).dump(-1, ' ', false, Json::error_handler_t::replace));
  zip.commit();
}

}  // namespace vkopple
