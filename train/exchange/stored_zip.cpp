#include "train/exchange/stored_zip.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/file_descriptor.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlock = std::size_t{1} << 16;
constexpr std::size_t kMaxMembers = 100'000;

class ZipReader {
 public:
  explicit ZipReader(fs::path path)
      : path_(std::move(path)), file_(open_for_reading(path_)), archive_(archive_read_new()) {
    struct stat info {};
    if (::fstat(file_.get(), &info) != 0) fail("its size can't be read");
    bytes_left_ = static_cast<std::uint64_t>(info.st_size);
    archive_read_support_format_zip_seekable(archive_.get());
    if (archive_read_open_fd(archive_.get(), file_.get(), kBlock) != ARCHIVE_OK) fail_by_library();
  }

  std::map<std::string, std::vector<std::byte>> members() {
    std::map<std::string, std::vector<std::byte>> all;
    archive_entry* entry = nullptr;
    for (;;) {
      const int result = archive_read_next_header(archive_.get(), &entry);
      if (result == ARCHIVE_EOF) return all;
      if (result != ARCHIVE_OK) fail_by_library();
      if (archive_entry_filetype(entry) == AE_IFDIR) continue;
      const char* name = archive_entry_pathname(entry);
      if (name == nullptr || archive_entry_filetype(entry) != AE_IFREG)
        fail("it holds a member that is not a file");
      name_ = name;
      if (all.size() >= kMaxMembers) fail(fmt::format("more than {} members", kMaxMembers));
      if (!all.emplace(name_, read_member(entry)).second) fail("it is there twice");
    }
  }

 private:
  struct Close {
    void operator()(archive* a) const { archive_read_free(a); }
  };

  /// libarchive says the method of a member in the format's name alone: "ZIP 2.0 (uncompressed)".
  bool is_stored() const {
    const char* format = archive_format_name(archive_.get());
    return format != nullptr && std::string_view(format).ends_with("(uncompressed)");
  }

  std::vector<std::byte> read_member(archive_entry* entry) {
    if (!is_stored())
      fail("it is compressed, and only stored members are read; save the file without compression");
    const std::int64_t size = archive_entry_size_is_set(entry) != 0 ? archive_entry_size(entry) : -1;
    if (size < 0 || static_cast<std::uint64_t>(size) > bytes_left_)
      fail("it is longer than the rest of the file; fetch or save it again");
    bytes_left_ -= static_cast<std::uint64_t>(size);
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    std::size_t used = 0;
    while (used < bytes.size()) {
      const la_ssize_t got = archive_read_data(archive_.get(), bytes.data() + used, bytes.size() - used);
      if (got < 0) fail_by_library();
      if (got == 0) fail("it is shorter than the zip says");
      used += static_cast<std::size_t>(got);
    }
    std::byte more{};
    // Reading on to the end is what checks the sum.
    const la_ssize_t rest = archive_read_data(archive_.get(), &more, 1);
    if (rest < 0) fail_by_library();
    if (rest > 0) fail("it is longer than the zip says");
    return bytes;
  }

  [[noreturn]] void fail(const std::string& what) const {
    const std::string file = one_line(path_.string(), 4096);
    throw Error(name_.empty() ? fmt::format("{}: {}", file, what)
                              : fmt::format("{}: member {}: {}", file, quote(name_), what));
  }
  [[noreturn]] void fail_by_library() const {
    const char* why = archive_error_string(archive_.get());
    fail(fmt::format("not a whole zip file ({}); fetch or save it again",
                     one_line(why == nullptr ? "damaged" : why)));
  }

  fs::path path_;
  FileDescriptor file_;
  std::unique_ptr<archive, Close> archive_;
  std::string name_;              ///< of the member at hand
  std::uint64_t bytes_left_ = 0;  ///< that members can still be made of
};

}  // namespace

std::map<std::string, std::vector<std::byte>> read_stored_zip(const fs::path& path) {
  return ZipReader(path).members();
}

bool is_zip(const fs::path& path) {
  constexpr std::string_view kMagic = "PK\x03\x04";
  const FileDescriptor file = open_for_reading(path);
  std::array<char, 4> start{};
  return ::pread(file.get(), start.data(), start.size(), 0) == static_cast<ssize_t>(start.size()) &&
         std::string_view(start.data(), start.size()) == kMagic;
}

}  // namespace vkopple
