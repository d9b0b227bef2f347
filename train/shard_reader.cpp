#include <archive.h>
#include <archive_entry.h>
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/quote.h"
#include "train/shards.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReadBytes = std::size_t{1} << 16;
constexpr std::int64_t kEndBytes = 1024;  // a tar file ends with two blocks of zeros

struct Release {
  void operator()(archive* a) const { archive_read_free(a); }
};

std::vector<fs::path> find_shards(const fs::path& path) {
  std::error_code failed;
  if (!fs::is_directory(path, failed)) return {path};
  std::vector<fs::path> shards;
  for (auto entry = fs::directory_iterator(path, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed)) {
    if (entry->path().extension() == ".tar") shards.push_back(entry->path());
  }
  if (failed)
    throw Error(fmt::format("cannot read the folder {}: {}", quote(path.string(), 4096), failed.message()));
  if (shards.empty())
    throw Error(fmt::format("no .tar file lies in {}; name a data set's folder or a shard",
                            quote(path.string(), 4096)));
  std::sort(shards.begin(), shards.end());
  return shards;
}

}  // namespace

std::string Sample::where(const std::string& extension) const {
  return one_line(fmt::format("{}: {}.{}", shard.string(), key, extension), 4096);
}

const std::vector<std::byte>& Sample::part(const std::string& extension) const {
  const auto found = parts.find(extension);
  if (found == parts.end()) throw Error(where(extension) + " is missing from the data set");
  return found->second;
}

/// One shard, read from its start.
class ShardReader::Tar {
 public:
  Tar(fs::path path, const ShardLimits& limits)
      : path_(std::move(path)), limits_(limits), file_(open_for_reading(path_)), archive_(archive_read_new()) {
    check_end();
    archive_read_support_format_tar(archive_.get());
    archive_read_support_filter_none(archive_.get());
    if (archive_read_open_fd(archive_.get(), file_.get(), kReadBytes) != ARCHIVE_OK)
      fail_by_library("not a tar file");
    advance();
  }

  /// The members of the next key.
  void next(std::optional<Sample>& result) {
    if (!open_sample()) return;
    Sample sample{key_, {}, path_};
    each_member([&] { sample.parts.emplace(extension_, read_member()); });
    result = std::move(sample);
  }
  void next(std::optional<SamplePlace>& result) {
    if (!open_sample()) return;
    SamplePlace place{key_, 0, {}};
    // No filter stands between the file and the tar, so what was consumed by now is where the member's bytes
    // begin.
    each_member([&] {
      const auto offset = static_cast<std::uint64_t>(archive_filter_bytes(archive_.get(), 0));
      place.parts.push_back({extension_, offset, member_bytes()});
    });
    result = std::move(place);
  }

 private:
  /// False at the end.
  bool open_sample() {
    if (entry_ == nullptr) return false;
    if (keys_.size() >= limits_.max_samples) fail(fmt::format("more than {} samples", limits_.max_samples));
    if (!keys_.insert(key_).second)
      fail(fmt::format("the members of sample {} do not lie together", quote(key_)));
    return true;
  }

  template <class Take>
  void each_member(const Take& take) {
    const std::string key = key_;
    std::set<std::string> seen;
    while (entry_ != nullptr && key_ == key) {
      if (seen.size() >= limits_.max_parts)
        fail(fmt::format("more than {} members in one sample", limits_.max_parts));
      if (!seen.insert(extension_).second) fail("it is there twice");
      take();
      advance();
    }
  }

  /// The library takes a file that is cut off between two members for complete.
  void check_end() {
    struct stat info {};
    std::array<char, kEndBytes> end{};
    const bool whole = ::fstat(file_.get(), &info) == 0 && info.st_size % 512 == 0 &&
                       info.st_size >= kEndBytes &&
                       ::pread(file_.get(), end.data(), end.size(), info.st_size - kEndBytes) == kEndBytes;
    if (!whole || std::any_of(end.begin(), end.end(), [](char c) { return c != 0; })) {
      fail("not an uncompressed tar file, or one that is cut off; fetch or generate it again");
    }
    file_bytes_ = static_cast<std::uint64_t>(info.st_size);
  }

  /// To the next plain file, whose name is split into key_ and extension_.
  void advance() {
    do {
      const int result = archive_read_next_header(archive_.get(), &entry_);
      if (result == ARCHIVE_EOF) {
        entry_ = nullptr;
        return;
      }
      if (result != ARCHIVE_OK) fail_by_library("damaged");
      const char* name = archive_entry_pathname(entry_);
      member_ = name != nullptr ? name : "";
      check_name();
    } while (archive_entry_filetype(entry_) == AE_IFDIR);
    if (archive_entry_filetype(entry_) != AE_IFREG || archive_entry_hardlink(entry_) != nullptr ||
        archive_entry_sparse_count(entry_) > 0)
      fail("it is not a plain file");
    split_name();
  }

  void check_name() const {
    if (member_.empty() || member_.front() == '/') fail("its name is empty or absolute");
    if (("/" + member_ + "/").find("/../") != std::string::npos)
      fail("its name climbs out of the folder with '..'");
  }

  void split_name() {
    std::string_view name = member_;
    while (name.starts_with("./")) name.remove_prefix(2);
    const auto slash = name.rfind('/');
    const auto dot = name.find('.', slash == std::string_view::npos ? 0 : slash + 1);
    if (dot == std::string_view::npos || name.substr(0, dot).empty() || name.substr(0, dot).ends_with('/')) {
      fail("its name is not of the form KEY.EXTENSION");
    }
    key_ = name.substr(0, dot);
    extension_ = name.substr(dot + 1);
    const std::string suffix = extension_.substr(extension_.rfind('.') + 1);
    if (!limits_.suffixes.contains(suffix)) {
      fail(fmt::format("unknown kind of file {}; known are {}", quote("." + suffix),
                       fmt::join(limits_.suffixes, ", ")));
    }
  }

  std::uint64_t member_bytes() const {
    const std::int64_t size = archive_entry_size_is_set(entry_) != 0 ? archive_entry_size(entry_) : -1;
    if (size < 0 || static_cast<std::uint64_t>(size) > limits_.max_part_bytes) {
      fail(fmt::format("its size of {} bytes is not within the limit of {}", size, limits_.max_part_bytes));
    }
    if (static_cast<std::uint64_t>(size) > file_bytes_) fail("it is cut off");
    return static_cast<std::uint64_t>(size);
  }

  std::vector<std::byte> read_member() const {
    std::vector<std::byte> bytes(member_bytes());
    std::size_t used = 0;
    while (used < bytes.size()) {
      const la_ssize_t got = archive_read_data(archive_.get(), bytes.data() + used, bytes.size() - used);
      if (got < 0) fail_by_library("damaged");
      if (got == 0) fail("it is cut off");
      used += static_cast<std::size_t>(got);
    }
    return bytes;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    const std::string member = member_.empty() ? "" : ": " + quote(member_);
    throw Error(fmt::format("{}{}: {}", one_line(path_.string(), 4096), member, reason));
  }
  [[noreturn]] void fail_by_library(const std::string& what) const {
    const char* why = archive_error_string(archive_.get());
    const std::string place = member_.empty() ? "" : " after " + quote(member_);
    throw Error(fmt::format("{}: {}{}: {}", one_line(path_.string(), 4096), what, place,
                            one_line(why != nullptr ? why : "unknown reason")));
  }

  fs::path path_;
  const ShardLimits& limits_;
  FileDescriptor file_;
  std::uint64_t file_bytes_ = 0;
  std::unique_ptr<archive, Release> archive_;
  archive_entry* entry_ = nullptr;  ///< owned by the archive; null at the end
  std::string member_, key_, extension_;
  std::set<std::string> keys_;
};

ShardReader::ShardReader(const fs::path& path, ShardLimits limits)
    : shards_(find_shards(path)), limits_(std::move(limits)) {}

ShardReader::~ShardReader() = default;

template <class Result>
std::optional<Result> ShardReader::next_as() {
  std::optional<Result> result;
  while (true) {
    if (tar_) {
      tar_->next(result);
      if (result) return result;
      tar_.reset();
    }
    if (opened_ == shards_.size()) return std::nullopt;
    tar_ = std::make_unique<Tar>(shards_[opened_++], limits_);
  }
}

std::optional<Sample> ShardReader::next() { return next_as<Sample>(); }

std::optional<SamplePlace> ShardReader::next_place() {
  std::optional<SamplePlace> place = next_as<SamplePlace>();
  if (place) place->shard = opened_ - 1;
  return place;
}

Sample ShardReader::read(const SamplePlace& place, const std::set<std::string>& extensions) const {
  Sample sample{place.key, {}, shards_.at(place.shard)};
  const FileDescriptor file = open_for_reading(sample.shard);
  for (const SamplePlace::Part& part : place.parts) {
    if (!extensions.empty() && !extensions.contains(part.extension)) continue;
    std::vector<std::byte> bytes(part.bytes);
    std::size_t used = 0;
    while (used < bytes.size()) {
      const ssize_t got =
          ::pread(file.get(), bytes.data() + used, bytes.size() - used, static_cast<off_t>(part.offset + used));
      if (got <= 0)
        throw Error(sample.where(part.extension) + " can't be read: the shard changed; start again");
      used += static_cast<std::size_t>(got);
    }
    sample.parts.emplace(part.extension, std::move(bytes));
  }
  return sample;
}

void ShardReader::rewind() {
  tar_.reset();
  opened_ = 0;
}

}  // namespace vkopple
