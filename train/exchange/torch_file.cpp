#include "train/exchange/torch_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>
#include <span>

#include "runtime/error.h"
#include "train/exchange/stored_zip.h"
#include "train/exchange/torch_types.h"
#include "train/json_io.h"
#include "train/pickle/pickle.h"
#include "train/quote.h"

namespace vkopple {
namespace {

constexpr std::size_t kMaxDimensions = 16;
constexpr std::string_view kPickleMember = "data.pkl";
constexpr std::string_view kStorageFolder = "data/";
constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();

std::string shown(const std::filesystem::path& path) { return one_line(path.string(), 4096); }

const std::set<std::string>& allowed_globals() {
  static const std::set<std::string> names = [] {
    std::set<std::string> all{std::string(kRebuildTensor)};
    for (const TorchStorage& storage : kTorchStorages) all.insert(fmt::format("torch.{}", storage.name));
    return all;
  }();
  return names;
}

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::int64_t> naturals(const PickleView& view) {
  if (view.size() > kMaxDimensions)
    throw Error(fmt::format("{} has more than {} items", view.where(), kMaxDimensions));
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < view.size(); ++i) numbers.push_back(view[i].integer(0, kMost));
  return numbers;
}

/// Copies row by row of the innermost axis.
void gather(const std::byte* from, const StoredShape& shape, const std::vector<std::int64_t>& strides,
            std::size_t axis, std::int64_t size, std::byte*& to) {
  const std::int64_t count = axis < shape.size() ? shape[axis] : 1;
  const std::int64_t stride = axis < shape.size() ? strides[axis] : 1;
  if (axis + 1 >= shape.size() && stride == 1) {
    std::memcpy(to, from, static_cast<std::size_t>(count * size));
    to += count * size;
    return;
  }
  for (std::int64_t i = 0; i < count; ++i) {
    if (axis + 1 < shape.size()) {
      gather(from + i * stride * size, shape, strides, axis + 1, size, to);
    } else {
      std::memcpy(to, from + i * stride * size, static_cast<std::size_t>(size));
      to += size;
    }
  }
}

}  // namespace

bool has_torch_ending(const std::filesystem::path& path) {
  return path.extension() == ".pt" || path.extension() == ".pth";
}

TorchFile::TorchFile(std::filesystem::path path) : path_(std::move(path)) {
  if (!is_zip(path_)) {
    throw Error(
        fmt::format("{}: is no zip file, as PyTorch writes since version 1.6; load and save it again with a "
                    "newer PyTorch: torch.save(torch.load(FILE), FILE)",
                    shown(path_)));
  }
  read_members();
}

void TorchFile::read_members() {
  auto members = read_stored_zip(path_);
  // All lie in one folder, whose name is the writer's choice.
  const auto pickle = std::find_if(members.begin(), members.end(), [](const auto& member) {
    const std::string& name = member.first;
    return name.ends_with(kPickleMember) && std::count(name.begin(), name.end(), '/') == 1 &&
           name.find('/') + 1 + kPickleMember.size() == name.size();
  });
  if (pickle == members.end())
    throw Error(fmt::format("{}: has no member FOLDER/{}; it is not what torch.save writes", shown(path_),
                            kPickleMember));
  const std::string folder = pickle->first.substr(0, pickle->first.size() - kPickleMember.size());
  if (const auto order = members.find(folder + "byteorder");
      order != members.end() && text_of(order->second) != "little")
    throw Error(fmt::format("{}: its byte order is {}; save it on a little-endian machine", shown(path_),
                            quote(text_of(order->second))));
  for (auto& [name, bytes] : members) {
    if (name.starts_with(folder + std::string(kStorageFolder)))
      storages_.emplace(name.substr(folder.size() + kStorageFolder.size()), std::move(bytes));
  }
  if (const auto said = members.find(folder + std::string(kTorchMetadataMember)); said != members.end())
    read_metadata(text_of(said->second));
  read_entries(pickle->second);
}

void TorchFile::read_metadata(const std::string& text) {
  const std::string source = fmt::format("{}: {}", shown(path_), kTorchMetadataMember);
  const Json json = parse_json(text, source);
  if (!json.is_object()) throw Error(source + " is not an object of strings");
  for (const auto& [key, value] : json.items()) metadata_.emplace(key, JsonView(value, source).string());
}

void TorchFile::read_entries(const std::vector<std::byte>& pickle) {
  const Pickle content(pickle, fmt::format("{}: {}", shown(path_), kPickleMember), allowed_globals());
  const PickleView view = content.view();
  if (!view.value().is(PickleKind::kDict)) {
    throw Error(
        fmt::format("{} holds {} instead of a dict of tensors; save the state dict alone: "
                    "torch.save(model.state_dict(), FILE)",
                    shown(path_), name_of(view.value().kind())));
  }
  const auto items = view.value().items();
  for (std::size_t i = 0; i < items.size(); i += 2) {
    if (!items[i].is(PickleKind::kString))
      throw Error(
          fmt::format("{}: a tensor's name is {} instead of a string", shown(path_), name_of(items[i].kind())));
    const std::string& name = items[i].text();
    const PickleView item(items[i + 1], fmt::format("{}: {}", shown(path_), quote(name)));
    if (!entries_.emplace(name, read_entry(item)).second)
      throw Error(fmt::format("{} is there twice", item.where()));
  }
}

/// _rebuild_tensor_v2(storage, offset, sizes, strides, requires_grad, hooks).
TorchFile::Entry TorchFile::read_entry(const PickleView& view) const {
  if (!view.value().is_call(kRebuildTensor)) {
    throw Error(
        fmt::format("{} is {}, not a tensor; save the state dict alone: torch.save(model.state_dict(), FILE)",
                    view.where(), name_of(view.value().kind())));
  }
  const auto arguments = view.value().arguments();
  if (arguments.size() < 4) throw Error(fmt::format("{} is described by too few numbers", view.where()));
  const auto argument = [&](std::size_t i, const char* what) {
    return PickleView(arguments[i], fmt::format("{}: {}", view.where(), what));
  };
  Entry entry;
  read_storage(argument(0, "storage"), entry);
  entry.offset = argument(1, "offset").integer(0, kMost);
  entry.shape = naturals(argument(2, "shape"));
  entry.strides = naturals(argument(3, "strides"));
  check_reach(view, entry);
  return entry;
}

/// ("storage", type, key, device, count), kept outside the pickle.
void TorchFile::read_storage(const PickleView& view, Entry& entry) const {
  if (!view.value().is(PickleKind::kPersistent)) view.fail("a storage");
  const PickleView id(view.value().items()[0], view.where());
  if (!id.value().is(PickleKind::kTuple) || id.size() != 5 || id[0].string() != "storage") id.fail("a storage");
  if (!id[1].value().is(PickleKind::kGlobal)) id[1].fail("the class of a storage");
  const auto* type = std::find_if(
      std::begin(kTorchStorages), std::end(kTorchStorages),
      [&](const TorchStorage& s) { return id[1].value().text() == fmt::format("torch.{}", s.name); });
  if (type == std::end(kTorchStorages)) id[1].fail("the class of a storage");
  entry.dtype = type->dtype;
  entry.storage = id[2].string();
  const auto found = storages_.find(entry.storage);
  if (found == storages_.end())
    throw Error(
        fmt::format("{}: the file has no member {}{}", view.where(), kStorageFolder, quote(entry.storage)));
  const std::int64_t count = id[4].integer(0, kMost);
  if (found->second.size() / dtype_size(entry.dtype) != static_cast<std::uint64_t>(count) ||
      found->second.size() % dtype_size(entry.dtype) != 0) {
    throw Error(fmt::format("{}: {} elements in {} bytes do not fit; the file is damaged", view.where(), count,
                            found->second.size()));
  }
}

/// The last element lies within the storage, and none is there more often than the storage is long (which an
/// expanded tensor would need).
void TorchFile::check_reach(const PickleView& view, const Entry& entry) const {
  const auto fail = [&](const char* what) {
    throw Error(fmt::format("{} {}: shape {}, strides {}, offset {}", view.where(), what,
                            to_string(entry.shape), to_string(entry.strides), entry.offset));
  };
  const auto length = static_cast<std::int64_t>(storages_.at(entry.storage).size() / dtype_size(entry.dtype));
  if (entry.shape.size() != entry.strides.size()) fail("has not as many strides as sizes");
  const auto count = element_count(entry.shape);
  if (!count || *count > length) fail("has more elements than its storage; save it with .contiguous()");
  if (*count == 0) return;
  std::int64_t last = entry.offset;
  for (std::size_t i = 0; i < entry.shape.size(); ++i) {
    std::int64_t step = 0;
    if (__builtin_mul_overflow(entry.shape[i] - 1, entry.strides[i], &step) ||
        __builtin_add_overflow(last, step, &last))
      fail("reaches beyond its storage");
  }
  if (last >= length) fail("reaches beyond its storage");
}

std::vector<std::string> TorchFile::names() const {
  std::vector<std::string> names;
  for (const auto& item : entries_) names.push_back(item.first);
  return names;
}

const TorchFile::Entry& TorchFile::entry(const std::string& name) const {
  const auto found = entries_.find(name);
  if (found == entries_.end())
    throw Error(
        fmt::format("{}: it has no tensor {}; is it a file for another model?", shown(path_), quote(name)));
  return found->second;
}

StoredTensor TorchFile::read(const std::string& name) const {
  const Entry& where = entry(name);
  const auto size = static_cast<std::int64_t>(dtype_size(where.dtype));
  StoredTensor tensor{where.dtype, where.shape, {}};
  tensor.bytes.resize(static_cast<std::size_t>(*element_count(where.shape) * size));
  if (tensor.bytes.empty()) return tensor;
  std::byte* to = tensor.bytes.data();
  gather(storages_.at(where.storage).data() + where.offset * size, where.shape, where.strides, 0, size, to);
  return tensor;
}

}  // namespace vkopple
