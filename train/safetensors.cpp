#include "train/safetensors.h"

#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <set>
#include <system_error>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/json_io.h"
#include "train/quote.h"

namespace vkopple {
namespace {

constexpr std::uint64_t kLengthBytes = 8;
constexpr std::uint64_t kMaxHeaderBytes = 100'000'000;  // the format's own limit
constexpr std::size_t kMaxDimensions = 16;
constexpr JsonLimits kHeaderLimits{.max_depth = 4, .max_values = 2'000'000};  // some 200 thousand tensors
constexpr const char* kMetadataKey = "__metadata__";

std::string shown(const std::filesystem::path& path) { return one_line(path.string(), 4096); }

void read_exactly(const FileDescriptor& file, std::uint64_t offset, std::span<std::byte> into,
                  const std::filesystem::path& path) {
  while (!into.empty()) {
    const ssize_t got = ::pread(file.get(), into.data(), into.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw Error(fmt::format("cannot read {}: {}", shown(path), std::generic_category().message(errno)));
    if (got == 0) throw Error(fmt::format("{}: the file became shorter while it was read", shown(path)));
    offset += static_cast<std::uint64_t>(got);
    into = into.subspan(static_cast<std::size_t>(got));
  }
}

}  // namespace

/// Reads and checks all but the tensors' values.
class SafetensorsFile::HeaderReader {
 public:
  explicit HeaderReader(SafetensorsFile& file) : file_(file) {}

  void run() {
    const std::string text = read_text();
    const Json header = parse_json(text, shown(file_.path_) + " (header)", kHeaderLimits);
    for (const auto& [name, value] : header.items()) {
      if (name == kMetadataKey) {
        read_metadata(value);
      } else {
        file_.entries_.emplace(name, read_entry(name, value));
      }
    }
    check_tiling();
  }

 private:
  std::string read_text() {
    struct stat info {};
    if (::fstat(file_.file_.get(), &info) != 0) fail(std::generic_category().message(errno));
    const auto size = static_cast<std::uint64_t>(info.st_size);
    if (size < kLengthBytes + 2) fail("too short for a safetensors file; it may be cut off");
    std::array<std::byte, kLengthBytes> head{};
    read_exactly(file_.file_, 0, head, file_.path_);
    const auto length = std::bit_cast<std::uint64_t>(head);
    if (length > kMaxHeaderBytes) {
      fail(fmt::format("header of {} bytes, above the format's limit of {}; not a safetensors file?", length,
                       kMaxHeaderBytes));
    }
    if (length > size - kLengthBytes) {
      fail(fmt::format("header of {} bytes in a file of {}; it is cut off, fetch it again", length, size));
    }
    std::string text(static_cast<std::size_t>(length), '\0');
    read_exactly(file_.file_, kLengthBytes, std::as_writable_bytes(std::span(text)), file_.path_);
    if (text.empty() || text.front() != '{') fail("the header does not start with '{'; not a safetensors file");
    file_.data_start_ = kLengthBytes + length;
    data_size_ = size - file_.data_start_;
    return text;
  }

  void read_metadata(const Json& value) {
    if (!value.is_object()) fail("__metadata__ is not an object of strings");
    for (const auto& [key, text] : value.items()) {
      if (!text.is_string()) fail(fmt::format("__metadata__ {} is not a string", quote(key)));
      file_.metadata_.emplace(key, text.get<std::string>());
    }
  }

  Entry read_entry(const std::string& name, const Json& value) const {
    if (!value.is_object() || value.size() != 3 || !value.contains("dtype") || !value.contains("shape") ||
        !value.contains("data_offsets")) {
      fail(name, "needs exactly the keys dtype, shape and data_offsets");
    }
    const Json& type = value.at("dtype");
    if (!type.is_string()) fail(name, "its dtype is not a string");
    const auto dtype = dtype_from_name(type.get_ref<const std::string&>());
    if (!dtype) fail(name, fmt::format("unknown dtype {}", quote(type.get_ref<const std::string&>())));
    const auto offsets = naturals(name, "data_offsets", value.at("data_offsets"), 2);
    if (offsets.size() != 2 || offsets[0] > offsets[1])
      fail(name, "data_offsets must be [begin, end], begin <= end");
    Entry entry{*dtype, naturals(name, "shape", value.at("shape"), kMaxDimensions),
                static_cast<std::uint64_t>(offsets[0]), static_cast<std::uint64_t>(offsets[1])};
    check_size(name, entry);
    return entry;
  }

  std::vector<std::int64_t> naturals(const std::string& name, const char* key, const Json& list,
                                     std::size_t most) const {
    if (!list.is_array() || list.size() > most)
      fail(name, fmt::format("{} is not an array of at most {}", key, most));
    std::vector<std::int64_t> values;
    for (const Json& value : list) {
      if (!value.is_number_unsigned() || value.get<std::uint64_t>() > static_cast<std::uint64_t>(INT64_MAX)) {
        fail(name, fmt::format("{} holds something other than whole numbers from 0", key));
      }
      values.push_back(value.get<std::int64_t>());
    }
    return values;
  }

  void check_size(const std::string& name, const Entry& entry) const {
    const auto count = element_count(entry.shape);
    std::int64_t bytes = 0;
    if (!count || __builtin_mul_overflow(*count, static_cast<std::int64_t>(dtype_size(entry.dtype)), &bytes)) {
      fail(name, fmt::format("shape {} is too large", to_string(entry.shape)));
    }
    if (static_cast<std::uint64_t>(bytes) != entry.end - entry.begin) {
      fail(name, fmt::format("shape {} of {} takes {} bytes, but data_offsets give it {}",
                             to_string(entry.shape), dtype_name(entry.dtype), bytes, entry.end - entry.begin));
    }
    if (entry.end > data_size_) {
      fail(name, fmt::format("its data ends at byte {}, but the file holds {}; it is cut off, fetch it again",
                             entry.end, data_size_));
    }
  }

  /// In order of their data, each tensor must begin where the one before ended, and the last end with the file.
  void check_tiling() const {
    std::vector<const std::pair<const std::string, Entry>*> order;
    for (const auto& item : file_.entries_) order.push_back(&item);
    std::sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
      return std::pair(a->second.begin, a->second.end) < std::pair(b->second.begin, b->second.end);
    });
    std::uint64_t reached = 0;
    for (const auto* item : order) {
      if (item->second.begin < reached) fail(item->first, "its data overlaps that of another tensor");
      if (item->second.begin > reached) fail(item->first, "unused bytes lie before its data");
      reached = item->second.end;
    }
    if (reached != data_size_) fail(fmt::format("{} bytes beyond the last tensor", data_size_ - reached));
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw Error(fmt::format("{}: {}", shown(file_.path_), reason));
  }
  [[noreturn]] void fail(const std::string& tensor, const std::string& reason) const {
    throw Error(fmt::format("{}: tensor {}: {}", shown(file_.path_), quote(tensor), reason));
  }

  SafetensorsFile& file_;
  std::uint64_t data_size_ = 0;
};

SafetensorsFile::SafetensorsFile(std::filesystem::path path)
    : path_(std::move(path)), file_(open_for_reading(path_)) {
  HeaderReader(*this).run();
  checksums_.emplace(metadata_, path_);
}

std::vector<std::string> SafetensorsFile::names() const {
  std::vector<std::string> result;
  for (const auto& item : entries_) result.push_back(item.first);
  return result;
}

const SafetensorsFile::Entry& SafetensorsFile::entry(const std::string& name) const {
  const auto found = entries_.find(name);
  if (found == entries_.end()) {
    throw Error(
        fmt::format("{}: it has no tensor {}; is it a file for another model?", shown(path_), quote(name)));
  }
  return found->second;
}

StoredTensor SafetensorsFile::read(const std::string& name) const {
  const Entry& where = entry(name);
  StoredTensor tensor{where.dtype, where.shape, {}};
  tensor.bytes.resize(static_cast<std::size_t>(where.end - where.begin));
  read_exactly(file_, data_start_ + where.begin, tensor.bytes, path_);
  checksums_->check(name, tensor);
  return tensor;
}

std::vector<float> SafetensorsFile::read_floats(const std::string& name) const { return to_floats(read(name)); }

std::vector<double> SafetensorsFile::read_doubles(const std::string& name) const {
  return to_doubles(read(name));
}

std::vector<std::int64_t> SafetensorsFile::read_ints(const std::string& name) const {
  return to_ints(read(name), name, shown(path_));
}

std::vector<float> SafetensorsFile::read_floats(const std::string& name, const StoredShape& expected) const {
  if (shape(name) != expected) {
    throw Error(fmt::format("{}: tensor {} has shape {}, expected {}; is it a file for another configuration?",
                            shown(path_), quote(name), to_string(shape(name)), to_string(expected)));
  }
  std::vector<float> values = read_floats(name);
  require_finite(name, values, path_);
  return values;
}

}  // namespace vkopple
