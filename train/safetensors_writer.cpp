#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/json_io.h"
#include "train/quote.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

using Named = std::pair<const std::string, TensorView>;

void check(const std::filesystem::path& path, const Named& named) {
  const auto& [name, tensor] = named;
  const auto count = element_count(tensor.shape);
  const bool fits = count &&
                    static_cast<std::uint64_t>(*count) == tensor.bytes.size() / dtype_size(tensor.dtype) &&
                    tensor.bytes.size() % dtype_size(tensor.dtype) == 0;
  if (!fits || name == "__metadata__") {
    throw Error(
        fmt::format("cannot write {}: tensor {} of shape {} and {} bytes is not one that a file can hold",
                    one_line(path.string(), 4096), quote(name), to_string(tensor.shape), tensor.bytes.size()));
  }
}

/// Larger elements first keeps every tensor aligned to its own element size.
std::vector<const Named*> data_order(const std::map<std::string, TensorView>& tensors) {
  std::vector<const Named*> order;
  for (const Named& named : tensors) order.push_back(&named);
  std::stable_sort(order.begin(), order.end(), [](const Named* a, const Named* b) {
    return dtype_size(a->second.dtype) > dtype_size(b->second.dtype);
  });
  return order;
}

std::string quoted_json(const std::string& text) { return Json(text).dump(); }

std::string header_text(const std::map<std::string, std::string>& metadata,
                        const std::vector<const Named*>& order) {
  std::string text = "{";
  const auto separate = [&text] { text += text.back() == '{' ? "" : ","; };
  if (!metadata.empty()) {
    text += "\"__metadata__\":{";
    for (const auto& [key, value] : metadata) {
      separate();
      text += quoted_json(key) + ":" + quoted_json(value);
    }
    text += "}";
  }
  std::size_t begin = 0;
  for (const Named* named : order) {
    const auto& [name, tensor] = *named;
    separate();
    text +=
        fmt::format(R"({}:{{"dtype":"{}","shape":{},"data_offsets":[{},{}]}})", quoted_json(name),
                    dtype_name(tensor.dtype), Json(tensor.shape).dump(), begin, begin + tensor.bytes.size());
    begin += tensor.bytes.size();
  }
  text += "}";
  text.resize((text.size() + 7) / 8 * 8, ' ');
  return text;
}

}  // namespace

void write_safetensors(const std::filesystem::path& path, const std::map<std::string, std::string>& metadata,
                       const std::map<std::string, TensorView>& tensors, FileSystem& files) {
  for (const Named& named : tensors) check(path, named);
  const std::vector<const Named*> order = data_order(tensors);
  std::string header;
  try {
    header = header_text(metadata, order);
  } catch (const Json::exception&) {
    throw Error(fmt::format("cannot write {}: a name or metadata text in it is not UTF-8",
                            one_line(path.string(), 4096)));
  }
  AtomicFile file(path, files);
  const auto length = std::bit_cast<std::array<std::byte, 8>>(static_cast<std::uint64_t>(header.size()));
  file.write(length);
  file.write(header);
  for (const Named* named : order) file.write(named->second.bytes);
  file.commit();
}

void write_safetensors(const std::filesystem::path& path, const std::map<std::string, std::string>& metadata,
                       const std::map<std::string, StoredTensor>& tensors, FileSystem& files) {
  write_safetensors(path, metadata, std::map<std::string, TensorView>(tensors.begin(), tensors.end()), files);
}

}  // namespace vkopple
