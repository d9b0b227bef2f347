#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <span>

#include "runtime/error.h"
#include "train/archive_writer.h"
#include "train/exchange/torch_file.h"
#include "train/exchange/torch_types.h"
#include "train/json_io.h"
#include "train/pickle/pickle_writer.h"
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

std::vector<std::int64_t> strides_of(const StoredShape& shape) {
  std::vector<std::int64_t> strides(shape.size(), 1);
  for (std::size_t i = shape.size(); i-- > 1;)
    strides[i - 1] = strides[i] * std::max<std::int64_t>(shape[i], 1);
  return strides;
}

void write_tuple(PickleWriter& out, const std::vector<std::int64_t>& numbers) {
  out.tuple([&] {
    for (const std::int64_t number : numbers) out.whole(number);
  });
}

void write_ordered_dict(PickleWriter& out) {
  out.global("collections", "OrderedDict");
  out.empty_tuple();
  out.call();
}

void write_entry(PickleWriter& out, std::string_view storage, std::size_t key, const StoredTensor& tensor) {
  out.global("torch._utils", "_rebuild_tensor_v2");
  out.tuple([&] {
    out.tuple([&] {
      out.text("storage");
      out.global("torch", storage);
      out.text(std::to_string(key));
      out.text("cpu");
      out.whole(element_count(tensor.shape).value());
    });
    out.persistent();
    out.whole(0);
    write_tuple(out, tensor.shape);
    write_tuple(out, strides_of(tensor.shape));
    out.truth(false);  // requires no gradient
    write_ordered_dict(out);
  });
  out.call();
}

std::string pickle_of(const std::filesystem::path& path, const std::map<std::string, StoredTensor>& tensors) {
  PickleWriter pickle;
  write_ordered_dict(pickle);
  pickle.entries([&] {
    std::size_t key = 0;
    for (const auto& [name, tensor] : tensors) {
      pickle.text(name);
      write_entry(pickle, storage_of(path, name, tensor.dtype), key++, tensor);
    }
  });
  return pickle.finish();
}

}  // namespace

void write_torch(const std::filesystem::path& path, const std::map<std::string, std::string>& metadata,
                 const std::map<std::string, StoredTensor>& tensors) {
  const std::string pickle = pickle_of(path, tensors);
  ArchiveWriter zip(path, ArchiveKind::kStoredZip);
  const auto add = [&](std::string_view name, std::string_view text) {
    zip.add(fmt::format("archive/{}", name), std::as_bytes(std::span(text)));
  };
  add("data.pkl", pickle);
  add("byteorder", "little");
  std::size_t key = 0;
  for (const auto& item : tensors) zip.add(fmt::format("archive/data/{}", key++), item.second.bytes);
  add("version", "3\n");
  if (!metadata.empty())
    add(kTorchMetadataMember, Json(metadata).dump(-1, ' ', false, Json::error_handler_t::replace));
  zip.commit();
}

}  // namespace vkopple
